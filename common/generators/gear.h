#pragma once
#include <vector>

#include "common/generators/family.h"

namespace mortise {

/// Gear.
std::vector<Family> gear_families();

}  // namespace mortise
