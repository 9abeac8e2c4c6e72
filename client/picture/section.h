#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// A plane that cuts parts, and the axes in which the cut is drawn: x_W = origin_W + x right_W +
/// y up_W. Unit and perpendicular; mm.
struct CutPlane {
  Vec3 origin_W = Vec3::Zero(), right_W = Vec3::UnitX(), up_W = Vec3::UnitY();

  Vec3 normal_W() const { return right_W.cross(up_W); }
  Vec2 project(const Vec3& x_W) const {
    return {(x_W - origin_W).dot(right_W), (x_W - origin_W).dot(up_W)};
  }
  Vec3 lift(const Vec2& x) const { return origin_W + x.x() * right_W + x.y() * up_W; }
};

/// One line along which a mesh is cut; piece i runs from points[i] to points[i + 1] over one
/// triangle. A closed line repeats its first point.
struct CutLine {
  std::vector<Vec2> points;
  std::vector<std::uint32_t> triangles;
  bool closed = false;
};

/// All lines along which the plane cuts the mesh. Corners on the plane count as above it, so that
/// closed meshes give closed lines. O(n).
std::vector<CutLine> cut_lines(const TriangleMesh& mesh, const Pose& X_WP, const CutPlane& plane);

/// The part of a polygon on the side x . normal >= offset of a line (Sutherland and Hodgman 1974).
std::vector<Vec2> clipped(const std::vector<Vec2>& polygon, const Vec2& normal, double offset_mm);

}  // namespace mortise
