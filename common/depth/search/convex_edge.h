#pragma once
#include "common/depth/body.h"

namespace mortise {

/// Is a point (part frame) outside of the least part because a face beside it, moved, cuts short
/// the face that it is judged by? At a convex edge the part is what lies below both faces, so that
/// a point near it has to be below each. Faces that meet smoothly, or at less than some 3 degrees,
/// are not asked. May be true of a point inside where other edges are near; never false of one that
/// a single convex edge cuts off. Costs a question to the triangles around the point.
bool is_past_convex_edge(const Body& body, const Vec3& x, double rounding_mm);

/// Lower bound of the depth of such a point in the least part, positive inside: of the faces near
/// it, those across convex edges included.
double depth_below_convex_edges(const Body& body, const Vec3& x);

}  // namespace mortise
