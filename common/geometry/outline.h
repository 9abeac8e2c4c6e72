#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/bvh/bvh.h"
#include "common/geometry/mesh.h"
#include "common/geometry/topology.h"

namespace mortise {

/// What the convex hull of a mesh shows. Part frame.
struct Outline {
  /// Corners of the hull and of flat faces of it: all corners of a small mesh, of a larger one
  /// those that are farthest along fixed directions.
  std::vector<Vec3> corners;
  bool complete = false;           ///< `corners` has every corner of the mesh
  std::vector<Vec3> main_normals;  ///< of the largest faces, up to four, no two along one line
  /// How far the mesh may fall short of its hull: the part holds a convex body that reaches, along
  /// any direction, no more than this less far than the hull. 0: convex. Infinity: not nearly
  /// convex, or without an inside.
  double convex_slack_mm = std::numeric_limits<double>::infinity();

  bool nearly_convex() const { return std::isfinite(convex_slack_mm); }
};

/// Deterministic. O(n log n) where the mesh is convex; less where it is plainly not.
Outline outline_of(const TriangleMesh& mesh, const Bvh& bvh, const Topology& topology);

/// The corner farthest along n (unit, part frame) and how far that is from the part's own origin:
/// exact. O(log n) typical.
Vec3 farthest_corner(const Bvh& bvh, const Outline& outline, const Vec3& n);

}  // namespace mortise
