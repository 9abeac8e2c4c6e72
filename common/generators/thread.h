#pragma once
#include <vector>

#include "common/generators/family.h"

namespace mortise {

/// Bolt, nut.
std::vector<Family> thread_families();

}  // namespace mortise
