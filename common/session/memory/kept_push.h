#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// The pushes of this tick that were held back only for lack of work, by part. Each is at most one
/// jump and half of the largest rotation of a tick; what is cut off is counted. Parts that slide or
/// are grouped have none, because their motion is computed anew in every tick. What constraints had
/// left of a push is what is kept of it.
std::vector<KeptPush> kept_pushes(const World& world, const Scratch::Impl& work,
                                  StepCounters& counters);

}  // namespace mortise
