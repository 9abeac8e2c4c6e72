#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 2. The pairs that could meet: broad phase, filter.
void find_candidate_pairs(const World& world, SessionState& state, Scratch::Impl& work,
                          StepReport& report);

}  // namespace mortise
