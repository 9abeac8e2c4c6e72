#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Invariants at the borders of the stages of a tick, checked in every build. A failure is a fault
/// of ours and aborts (MORTISE_CHECK). Each costs a few comparisons for each pair or part.

/// After the candidate pairs: each pair once, in order, of two parts of which one at least moves,
/// is placed or waits.
void check_pairs(const World& world, const Scratch::Impl& work);
/// After first contact and the response: times are within the tick, and no part goes on after its
/// stop.
void check_contacts(const Scratch::Impl& work);
/// After the verdicts: a region continues a clash that is open, and its class and its numbers do
/// not contradict each other.
void check_verdicts(const Scratch::Impl& work);
/// After the commit: poses are valid, and who waits stands in the order of the pairs.
void check_committed(const World& world, const SessionState& state, const StepReport& report);

}  // namespace mortise
