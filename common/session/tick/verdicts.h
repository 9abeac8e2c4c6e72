#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 4. Depth, thresholds and verdict of what is near; which clash each region continues.
void find_verdicts(const World& world, Scratch::Impl& work);

/// Is the pair told to be real, by a verdict that holds?
bool is_told_real(const PairWork& pair);

}  // namespace mortise
