#include "common/geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/base/hash.h"

namespace mortise {

bool valid(const TriangleMesh& mesh) {
  for (const Vec3& point : mesh.points_mm)
    for (const double x : point)  // a quiet comparison: no number raises nothing
      if (!std::islessequal(std::abs(x), kLargestCoordinate_mm)) return false;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      if (index >= mesh.points_mm.size()) return false;
  return true;
}

std::string mesh_hash(const TriangleMesh& mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  std::vector<std::byte> bytes(mesh.points_mm.size() * sizeof(Vec3) +
                               mesh.triangles.size() * sizeof(mesh.triangles[0]) +
                               (mesh.stated ? mesh.stated->size() : 0));
  std::byte* out = bytes.data();
  for (const Vec3& point : mesh.points_mm) {
    const Vec3 no_negative_zero = point.array() + 0.0;
    std::memcpy(out, no_negative_zero.data(), sizeof(Vec3));
    out += sizeof(Vec3);
  }
  if (!mesh.triangles.empty())
    std::memcpy(out, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  if (mesh.stated) std::ranges::copy(*mesh.stated, bytes.end() - std::ssize(*mesh.stated));
  return content_hash(bytes);
}

Box bounds_of(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3& point : mesh.points_mm) box.add(point);
  return box;
}

BoundingSphere bounding_sphere(const TriangleMesh& mesh) {
  if (mesh.points_mm.empty()) return {};
  const auto farthest_from = [&](const Vec3& from) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < mesh.points_mm.size(); ++i)
      if ((mesh.points_mm[i] - from).squaredNorm() > (mesh.points_mm[best] - from).squaredNorm())
        best = i;
    return mesh.points_mm[best];
  };
  // Ritter 1990: the span of two far points, grown by each point that is still outside.
  const Vec3 a = farthest_from(mesh.points_mm.front());
  const Vec3 b = farthest_from(a);
  BoundingSphere sphere{0.5 * (a + b), 0.5 * (b - a).norm()};
  for (const Vec3& point : mesh.points_mm) {
    const double distance = (point - sphere.center_mm).norm();
    if (distance <= sphere.radius_mm) continue;
    const double grown = 0.5 * (sphere.radius_mm + distance);
    sphere.center_mm += (point - sphere.center_mm) * ((distance - grown) / distance);
    sphere.radius_mm = grown;
  }
  // The box centre is often better for machine parts; take the smaller of both.
  const auto radius_about = [&](const Vec3& center) {
    return (farthest_from(center) - center).norm();
  };
  const Vec3 box_center = bounds_of(mesh).center();
  const double ritter = radius_about(sphere.center_mm);
  const double boxed = radius_about(box_center);
  return boxed <= ritter ? BoundingSphere{box_center, boxed}
                         : BoundingSphere{sphere.center_mm, ritter};
}

double signed_volume_mm3(const TriangleMesh& mesh) {
  MORTISE_CHECK(valid(mesh), "indices must name points, coordinates must be finite");
  const Vec3 center = bounds_of(mesh).center();
  double six_volumes = 0.0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    six_volumes += (mesh.corner(t, 0) - center)
                       .dot((mesh.corner(t, 1) - center).cross(mesh.corner(t, 2) - center));
  return six_volumes / 6.0;
}

TriangleMesh transformed(const TriangleMesh& mesh, const Pose& X) {
  TriangleMesh moved = mesh;
  for (Vec3& point : moved.points_mm) point = X * point;
  return moved;
}

}  // namespace mortise
