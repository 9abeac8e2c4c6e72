#pragma once
#include <cstdint>
#include <limits>

#include "common/geometry/solid.h"

namespace mortise {

struct NearestPoint {
  double distance_mm = std::numeric_limits<double>::infinity();  ///< unsigned
  Vec3 point = Vec3::Zero();  ///< nearest point of the mesh, part frame
  std::uint32_t triangle = 0;
};

/// Nearest point of the mesh to x (part frame), not farther than limit_mm: triangle is kNone
/// beyond. Ties go to the lower triangle id. Exact to rounding. O(log n) typical.
NearestPoint nearest_point(const Solid& solid, const Vec3& x,
                           double limit_mm = std::numeric_limits<double>::infinity());

/// Is x inside the material? Sign by generalized winding number over the tree (> 1/2), right for
/// closed meshes and a majority vote for dirty ones.
bool inside(const Solid& solid, const Vec3& x);

/// Negative inside.
double signed_distance_mm(const Solid& solid, const Vec3& x);

/// The slow twins: every triangle asked.
NearestPoint nearest_point_brute_force(const TriangleMesh& mesh, const Vec3& x);
double winding_number_brute_force(const TriangleMesh& mesh, const Vec3& x);

}  // namespace mortise
