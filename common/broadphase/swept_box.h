#pragma once
#include "common/geometry/mesh.h"
#include "common/motion/motion.h"

namespace mortise {

/// A body as the broad phase sees it, part frame, mm.
struct BodyBounds {
  Box box_P;
  BoundingSphere sphere_P;
};

/// World box that contains the body at every t in [0, 1] of the motion, mm. Exact for a pure
/// translation of a box; for a rotation by w grown by the sagitta radius * (1 - cos(w/2)) of the
/// arcs. Rounding is not covered, because the caller grows the box anyway.
Box swept_box(const BodyBounds& body, const Motion& motion);

}  // namespace mortise
