#pragma once
#include <vector>

#include "common/io/step/importer/step_tree.h"

namespace mortise {

/// Seconds of processor that one operation may take, and of the clock for all together.
struct CommonLimits {
  unsigned each_s, all_s;
};

/// The volume and surface that pairs of parts have in common by exact Boolean operations, each in a
/// process of its own: some never end, some crash. Those whose turn does not come in time are not
/// known.
std::vector<StepCommon> common_volumes(const StepTree& tree,
                                       const std::vector<StepCommonQuery>& queries,
                                       const CommonLimits& limits);

}  // namespace mortise
