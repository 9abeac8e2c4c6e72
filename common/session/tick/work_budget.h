#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

// What a tick may spend on depth, counted in evaluations (some 3 us each) and never in time, so
// that a replay decides the same. Pairs are served in the order of what users hold, who has waited
// longest first; each is given what it needed the last time and half as much again, and twice that
// after it came to the end of it. Who would not get that much waits rather than begin in vain: it
// is left at the time proven without a search, or with a short one, keeps the clashes that it has
// as they are, and is counted in pairs_waiting and not_examined. What ticks do not need is saved,
// up to a limit, for pairs that need more than one tick has.

/// Of all work a tick has so many times more under slide: a leg is searched like a push of its own,
/// and there are several of them in a tick.
inline constexpr std::uint64_t kSlideTimes = 2;

/// Does a user hold a part that moves in it?
bool is_held(const World& world, const PairWork& pair);

/// x - y, or nothing.
inline std::uint64_t less(std::uint64_t x, std::uint64_t y) { return x > y ? x - y : 0; }

/// Evaluations that are left of the tick, what is saved included.
std::uint64_t work_left(const Scratch::Impl& work);

/// Sets PairWork::cap and most_work of these pairs; cap 0 for those that have nothing; called
/// before they are asked.
void share_out(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
               WorkStage stage);

/// Remembers what it needed.
void note_effort(PairWork& pair, WorkStage stage, bool capped);

}  // namespace mortise
