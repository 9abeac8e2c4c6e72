#pragma once
#include "common/depth/cells/cover_outside.h"

namespace mortise {

/// Prisms below convex pieces of the outline of a plane face that holds the whole part: teeth and
/// the body that they stand on. No cells: no such face, or its outline falls into no such pieces.
Outside prism_outside(const CoverFaces& faces);

}  // namespace mortise
