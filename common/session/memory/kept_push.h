#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// The pushes of this tick that were held back for want of work and nothing else, by part. At most
/// one jump and half of the most rotation of a tick each; what is cut off is counted. Not of parts
/// that slide, are guided or grouped: what these are asked is computed anew in every tick.
std::vector<KeptPush> kept_pushes(const World& world, const Scratch::Impl& work,
                                  StepCounters& counters);

}  // namespace mortise
