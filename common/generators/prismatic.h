#pragma once
#include <vector>

#include "common/generators/family.h"

namespace mortise {

/// Block, key, slot_block, plates.
std::vector<Family> prismatic_families();

}  // namespace mortise
