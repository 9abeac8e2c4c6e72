#pragma once
#include <functional>

#include "common/session/tick/tick_work.h"

namespace mortise {

// What a tick may spend on depth, counted in evaluations (some 1.4 us each). Pairs are served in
// the order of in_order(); each is given what it needed the last time and half as much again. A
// pair that would not get that much waits, because a search that is cut short has no result: it is
// left at the time proven without a search, or with a short one, keeps the clashes that it has as
// they are, and is counted in pairs_waiting and not_examined. The pair that has waited longest is
// served after a few ticks in any case. Work that ticks do not need is saved, up to a limit.

/// Factor on the work of a tick under slide, because each of several legs is searched like a push.
inline constexpr std::uint64_t kSlideTimes = 2;

void open_depth_budget(const World& world, const SessionState& state, Scratch::Impl& work);
void close_depth_budget(SessionState& state, const Scratch::Impl& work);

/// Evaluations that are left of the tick, what is saved included.
std::uint64_t depth_work_left(const Scratch::Impl& work);

using ServePair = std::function<void(PairWork&, CcdScratch&)>;

/// Serves these pairs on all threads, those that have waited longest first, with PairWork::cap and
/// most_work set; cap 0 where the tick has nothing for the pair. Goes on with what the first ones
/// did not need.
void serve_in_turn(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
                   WorkStage stage, const ServePair& serve);

/// Sets PairWork::cap of pairs of which an event is told, for the times and the motion that it
/// carries. Each has an equal part of what the tick has left; with little of it brackets are wide.
void share_telling_work(Scratch::Impl& work, std::span<const std::uint32_t> pairs);

/// Remembers what the pair used in the stage.
void note_depth_effort(PairWork& pair, WorkStage stage, bool capped);

}  // namespace mortise
