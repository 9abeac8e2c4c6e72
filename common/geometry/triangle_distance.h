#pragma once
#include <array>

#include "common/math/types.h"

namespace mortise {

using Triangle = std::array<Vec3, 3>;

struct TriangleDistance {
  double distance_mm = 0.0;                             ///< 0 when the triangles cross or touch
  Vec3 point_a = Vec3::Zero(), point_b = Vec3::Zero();  ///< on the triangles, that far apart
  bool crossing = false;  ///< an edge of one passes through the face of the other
};

/// Distance of two solid triangles with witness points (README, section 3).
/// Scale-free: no absolute epsilon; the error is a few ulp of the coordinates, also for needles. A
/// triangle without area is treated as its edges. Corners must be finite, else the distance is NaN
/// or infinite (not checked here, because this is the hot path).
TriangleDistance triangle_distance(const Triangle& a, const Triangle& b);

/// The same for triangles that are known not to cross: the test for crossing is left out.
TriangleDistance triangle_distance_apart(const Triangle& a, const Triangle& b);

/// Does an edge of one pass through the face of the other? False for coplanar triangles.
bool triangles_cross(const Triangle& a, const Triangle& b);

/// Signed distance of two triangles as convex sets.
struct TriangleSeparation {
  double distance_mm = 0.0;    ///< > 0: a lower bound of the distance along `normal`;
                               ///< < 0: minus the least translation that takes them apart
  Vec3 normal = Vec3::Zero();  ///< unit, from a to b
};

/// Best of the separating axes: both normals, edge by edge, edges in their planes.
TriangleSeparation triangle_separation(const Triangle& a, const Triangle& b);

/// The same for triangles with an outside (counter-clockwise seen from there). A direction that
/// points behind the back of both does not separate them. So a face that has passed straight
/// through a face opposite to it is as deep as it went, where triangle_separation() calls them
/// apart again.
TriangleSeparation triangle_separation_outside(const Triangle& a, const Triangle& b);

}  // namespace mortise
