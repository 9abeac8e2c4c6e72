#pragma once
#include <vector>

#include "common/io/step/importer/step_tree.h"

namespace mortise {

/// The volume and surface that pairs of parts have in common by exact Boolean operations, each in a
/// process of its own with so many seconds of processor: some never end, some crash.
std::vector<StepCommon> common_volumes(const StepTree& tree,
                                       const std::vector<StepCommonQuery>& queries,
                                       unsigned seconds_each);

}  // namespace mortise
