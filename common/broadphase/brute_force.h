#pragma once
#include <memory>

#include "common/broadphase/broad_phase.h"

namespace mortise {

/// The slow twin: every moved part against every part.
std::unique_ptr<BroadPhase> make_brute_force();

}  // namespace mortise
