#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 5. New poses, written once.
void commit(World& world, SessionState& state, Scratch::Impl& work, StepReport& report);

}  // namespace mortise
