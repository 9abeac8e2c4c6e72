#include "common/geometry/same_face.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace mortise {
namespace {

bool near(double a, double b) { return std::fabs(a - b) <= kSameFace_mm; }

// Directions that part by less than the limit over the reach.
bool along(const Vec3& a, const Vec3& b, double reach_mm) {
  return a.normalized().cross(b.normalized()).norm() * reach_mm <= kSameFace_mm;
}

bool on_axis(const Vec3& point, const Surface& s) {
  const Vec3 off = point - s.point, axis = s.axis.normalized();
  return (off - off.dot(axis) * axis).norm() <= kSameFace_mm;
}

}  // namespace

bool same_face(const Surface& a, const Surface& b, double reach_mm) {
  if (a.kind != b.kind || a.inward != b.inward) return false;
  switch (a.kind) {
    case SurfaceKind::kPlane:
      return a.axis.dot(b.axis) > 0.0 && along(a.axis, b.axis, reach_mm) &&
             std::fabs((b.point - a.point).dot(a.axis.normalized())) <= kSameFace_mm;
    case SurfaceKind::kCylinder:
      return near(a.radius_mm, b.radius_mm) && along(a.axis, b.axis, reach_mm) &&
             on_axis(b.point, a);
    case SurfaceKind::kCone:
      return a.axis.dot(b.axis) > 0.0 && along(a.axis, b.axis, reach_mm) &&
             std::fabs(a.half_angle_rad - b.half_angle_rad) * reach_mm <= kSameFace_mm &&
             (a.point - b.point).norm() <= kSameFace_mm;
    case SurfaceKind::kSphere:
      return near(a.radius_mm, b.radius_mm) && (a.point - b.point).norm() <= kSameFace_mm;
    case SurfaceKind::kTorus:
      return near(a.radius_mm, b.radius_mm) && near(a.tube_radius_mm, b.tube_radius_mm) &&
             along(a.axis, b.axis, reach_mm) && (a.point - b.point).norm() <= kSameFace_mm;
    case SurfaceKind::kUnknown:
      break;
  }
  return false;
}

Vec3 middle_of(const Feature& feature, const TriangleMesh& mesh) {
  double area = 0.0;  // twice the area, as the weight of a facet
  Vec3 moment = Vec3::Zero();
  for (const std::uint32_t t : feature.triangles) {
    const Vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double weight = (b - a).cross(c - a).norm();
    area += weight;
    moment += weight / 3.0 * (a + b + c);
  }
  return area > 0.0 ? Vec3(moment / area) : feature.surface.point;
}

std::vector<std::optional<std::size_t>> find_again(std::span<const SoughtFace> sought,
                                                   std::span<const Feature> features,
                                                   const TriangleMesh& mesh, double reach_mm) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t j = 0; j < features.size(); ++j) {
    std::optional<Vec3> middle;
    for (std::size_t i = 0; i < sought.size(); ++i) {
      if (!same_face(sought[i].surface, features[j].surface, reach_mm)) continue;
      if (!middle) middle = middle_of(features[j], mesh);
      pairs.emplace_back((*middle - sought[i].middle_P).norm(), i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::optional<std::size_t>> found(sought.size());
  std::vector<bool> taken(features.size(), false);
  for (const auto& [apart_mm, i, j] : pairs) {
    if (found[i] || taken[j]) continue;
    found[i] = j;
    taken[j] = true;
  }
  return found;
}

}  // namespace mortise
