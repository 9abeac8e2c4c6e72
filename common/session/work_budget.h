#pragma once
#include "common/session/tick_work.h"

namespace mortise {

// What a tick may spend on depth, counted in evaluations (some 3 us each) and never in time, so
// that a replay decides the same. Pairs are served in the order of what users hold, who has waited
// longest first; each is given what it needed the last time, and twice that after it came to the
// end of it. Who is given nothing is left at the time proven without a search, keeps the clashes it
// has, and is counted in pairs_waiting and not_examined. What quiet ticks do not need is saved, up
// to a limit, so that what happens now and then is searched at once.

/// Evaluations that are left of the tick.
std::uint64_t work_left(const Scratch::Impl& work);

/// Sets PairWork::cap of these pairs, 0 for those that have to wait; called before they are asked.
void share_out(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
               WorkStage stage);

/// Did it have less than the most that a pair may have?
bool may_have_more(const PairWork& pair, WorkStage stage);

/// Remembers what they needed.
void note_effort(PairWork& pair, WorkStage stage, bool capped);

}  // namespace mortise
