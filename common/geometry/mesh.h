#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/math/box.h"
#include "common/math/pose.h"

namespace mortise {

/// Triangles over shared points, part frame, mm. Counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// What its CAD file states of the faces of exactly these triangles, where it came as such a part
  /// into a running session: bytes of io/scenario/brought_part.h. Null: nothing.
  std::shared_ptr<const std::vector<std::byte>> stated = {};

  const Vec3& corner(std::uint32_t triangle, int k) const {
    return points_mm[triangles[triangle][k]];
  }
};

/// Every index names a point; coordinates are finite and not beyond kLargestCoordinate_mm.
/// Functions of this room expect such a mesh; it may be empty. O(n).
bool valid(const TriangleMesh& mesh);

/// Hash of points, triangles and what is stated of them: 32 hex digits, the name of the mesh
/// everywhere.
std::string mesh_hash(const TriangleMesh& mesh);

/// Box of all points.
Box bounds_of(const TriangleMesh& mesh);

struct BoundingSphere {
  Vec3 center_mm = Vec3::Zero();
  double radius_mm = 0.0;
};

/// A small sphere around all points (Ritter's, with a final exact radius); deterministic. The
/// centre is the part's reference point.
BoundingSphere bounding_sphere(const TriangleMesh& mesh);

/// Signed volume, mm^3; positive when closed and outward oriented.
double signed_volume_mm3(const TriangleMesh& mesh);

/// The mesh moved by X: points X * p.
TriangleMesh transformed(const TriangleMesh& mesh, const Pose& X);

}  // namespace mortise
