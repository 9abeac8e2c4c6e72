#pragma once
#include <memory>

#include "common/broadphase/broad_phase.h"

namespace mortise {

/// FCL's dynamic AABB tree (Debian's libfcl, used for boxes only) over boxes somewhat larger than
/// those given, with a list of neighbours for each part that ever moved. A part inside its larger
/// box costs a comparison with its neighbours; a part that leaves it costs O(log n).
std::unique_ptr<BroadPhase> make_dynamic_tree();

}  // namespace mortise
