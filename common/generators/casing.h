#pragma once
#include <vector>

#include "common/generators/family.h"

namespace mortise {

/// Housing, cover.
std::vector<Family> casing_families();

}  // namespace mortise
