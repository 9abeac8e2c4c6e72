#include "common/depth/answer/facet.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Triangles under one box; a box over more of them is cut first.
constexpr std::size_t kMostUnder = 24;

/// The projection of a box on a plane and a segment or a point of that plane: do they meet?
class Shadow {
 public:
  Shadow(const SpaceBox& box, const Vec3& normal) : box_(box), normal_(normal) {}

  bool meets(const Vec3& from, const Vec3& to) const {
    if (parts(normal_.cross(to - from), from, to)) return false;
    return std::none_of(box_.half.begin(), box_.half.end(),
                        [&](const Vec3& half) { return parts(normal_.cross(half), from, to); });
  }

 private:
  // Along this direction of the plane a gap is between them.
  bool parts(const Vec3& direction, const Vec3& from, const Vec3& to) const {
    double reach = 0.0;
    for (const Vec3& half : box_.half) reach += std::fabs(direction.dot(half));
    const double a = direction.dot(from - box_.center), b = direction.dot(to - box_.center);
    return std::min(a, b) > reach || std::max(a, b) < -reach;
  }

  const SpaceBox& box_;
  Vec3 normal_;
};

bool holds(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& normal, const Vec3& x) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3 from = mesh.corner(triangle, k), to = mesh.corner(triangle, (k + 1) % 3);
    if (normal.cross(to - from).dot(x - from) < 0.0) return false;
  }
  return true;
}

}  // namespace

// From the triangle under the middle on across each edge that is under the box.
bool is_over_facet(const Solid& solid, std::uint32_t triangle, const SpaceBox& box,
                   double flat_mm) {
  const TriangleMesh& mesh = solid.mesh();
  const Topology& topology = solid.topology();
  const Vec3& normal = topology.normal[triangle];
  const double height_mm = normal.dot(mesh.corner(triangle, 0));
  // And beyond the edge along which it lies: no fold.
  const auto goes_on = [&](std::uint32_t other, const Vec3& from, const Vec3& to) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (std::fabs(normal.dot(mesh.corner(other, k)) - height_mm) > flat_mm) return false;
      sum += mesh.corner(other, k) - from;
    }
    return normal.cross(to - from).dot(sum) < 0.0;
  };
  if (normal.isZero(0.0) || !holds(mesh, triangle, normal, box.center)) return false;
  const Shadow shadow(box, normal);
  std::array<std::uint32_t, kMostUnder> under{triangle};
  std::size_t count = 1;
  for (std::size_t i = 0; i < count; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 from = mesh.corner(under[i], k), to = mesh.corner(under[i], (k + 1) % 3);
      if (!shadow.meets(from, to)) continue;
      const std::uint32_t next = topology.neighbor[under[i]][k];
      if (next == Topology::kNone || !goes_on(next, from, to)) return false;
      const auto end = under.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(under.begin(), end, next) != end) continue;
      if (count == kMostUnder) return false;
      under[count++] = next;
    }
  return true;
}

}  // namespace mortise
