#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"

namespace mortise {

/// One face of the largest body, seen from one of its triangles: its declared surface, else the
/// plane of the triangle, moved outwards by the upper end of its band. Part frame, mm.
class LargestFace {
 public:
  LargestFace(const Solid& solid, const SurfaceBand& band, std::uint32_t triangle);

  /// How far x is above the moved face; negative on the side of the material.
  double above_mm(const Vec3& x) const;
  Vec3 outward(const Vec3& x) const;
  /// Outward offset from the declared surface or, without one, from the plane of the triangle.
  double offset_mm() const { return offset_mm_; }
  /// The point of the moved face nearest to x.
  Vec3 foot(const Vec3& x) const { return x - above_mm(x) * outward(x); }

 private:
  const Surface* surface_;
  Vec3 corner_, normal_;
  double offset_mm_;
};

/// Where the largest body, whose faces are moved outwards and trimmed anew, is farther from the
/// part as modelled than any of the faces that meet there is moved: at a convex edge of two faces,
/// or a corner of three (common/depth/README.md, section 10).
struct Tip {
  std::array<std::uint32_t, 3> triangles{};     ///< one of each face
  int faces = 2;                                ///< 2: an edge; 3: a corner
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< ends of the edge, part frame; one corner
  double travel_mm = 0.0;                       ///< how far the edge or corner moves
};

/// The point near x at which the faces of a tip meet: of two faces the one nearest to x. `moved`:
/// of the largest body; else of the surfaces and planes that its faces are moved from.
Vec3 meeting_point(const Solid& solid, const SurfaceBand& band, const Tip& tip, const Vec3& x,
                   bool moved);

/// Is the moved edge of two faces, seen from a point of the edge, between their normals there?
bool goes_outwards(const LargestFace& a, const LargestFace& b, const Vec3& x);

/// Tips of more than 20 times as far as their faces move are cut off there, as those of plane faces
/// are (PlaneFaces::kMostTravel), and faces that meet at less than some 3 degrees make none.
/// Nothing for a part without offsets. O(n).
std::vector<Tip> find_tips(const Solid& solid, const SurfaceBand& band);

}  // namespace mortise
