#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/solid.h"

namespace mortise {

/// The plane face of a triangle, continued across flat edges, below a box: a bound of depth that is
/// exact between parallel faces, however they are cut into triangles (README, section 1).
class FaceBelow {
 public:
  using Corners = std::array<Vec3, 8>;  ///< of a box, part frame, mm

  FaceBelow(const Solid& solid, std::uint32_t triangle);

  /// Do the feet of all points between the corners lie in the face? Then no such point is deeper in
  /// the part than distance_mm(). center: of the corners. False where that is not seen at once: an
  /// edge that ends the face lies below, or too many triangles do. Once an object.
  bool holds(const Corners& corners, const Vec3& center);

  double distance_mm(const Vec3& x) const;

 private:
  using Flat = Eigen::Vector2d;
  Flat flat(const Vec3& x) const { return {u_.dot(x - origin_), v_.dot(x - origin_)}; }
  double area_of(std::uint32_t t) const;
  bool is_in(std::uint32_t t, const Flat& x) const;
  bool misses(const Flat& from, const Flat& to) const;

  const TriangleMesh& mesh_;
  const Solid& solid_;
  Vec3 origin_, u_, v_, normal_;
  double off_mm_ = 0.0;
  Eigen::AlignedBox2d box_;
  std::vector<std::uint32_t> seen_;
};

}  // namespace mortise
