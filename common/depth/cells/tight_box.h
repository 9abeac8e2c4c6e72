#pragma once
#include "common/depth/cells/decide.h"
#include "common/math/box.h"

namespace mortise {

/// Box of what the part has in a box, with all that its faces may be moved by its band and by
/// `depth_mm` (README, section 10): none of its points there is outside. Frame of the box; empty
/// where there are none.
Box tight_box(const SharpPart& part, const Pose& X_BS, const Box& box, double depth_mm);

}  // namespace mortise
