#pragma once
#include <vector>

#include "common/generators/family.h"

namespace mortise {

/// Shaft, dowel, screw, ring, bearing.
std::vector<Family> turned_families();

}  // namespace mortise
