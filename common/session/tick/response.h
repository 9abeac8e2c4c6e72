#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 3b. Policy: who stops when.
void respond(const World& world, Scratch::Impl& work, StepReport& report);

/// Notes for the next tick by which place each pair held its parts back.
void note_held(const World& world, Scratch::Impl& work);

}  // namespace mortise
