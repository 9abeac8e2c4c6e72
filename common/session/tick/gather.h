#pragma once
#include <span>

#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 1. Increments to moves: checks, composition in order of arrival.
void gather(World& world, std::span<const Increment> increments, Scratch::Impl& work,
            StepReport& report);

}  // namespace mortise
