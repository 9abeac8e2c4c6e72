#include "common/depth/search/facing_tangent.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// A patch whose hull comes nearer to the axis than this share of the radius goes through it.
constexpr double kLeastRadiusShare = 1e-3;

}  // namespace

double depth_below_facing_tangent(const Patch& patch, const Surface& surface) {
  // A torus lies below any plane that its hull does: the one that faces the patch.
  if (surface.kind == SurfaceKind::kTorus) {
    const Patch::Circle hull{surface.point, surface.axis, surface.radius_mm,
                             surface.tube_radius_mm};
    const Vec3 facing = -patch.normal;
    return patch.depth_below_plane(facing, surface.point + hull.reach_mm(facing) * facing, 0.0);
  }
  const int n = patch.count;
  if (n <= 0) return std::numeric_limits<double>::infinity();
  std::array<Vec3, Patch::kMost> across;
  for (int i = 0; i < n; ++i) {
    const Vec3 d = patch.points[i] - surface.point;
    across[i] = d;
    if (surface.kind != SurfaceKind::kSphere) across[i] = d - d.dot(surface.axis) * surface.axis;
  }
  Vec3 nearest = across[0];
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const Vec3 &from = across[i], edge = across[j] - from;
      const double length2 = edge.squaredNorm();
      const double share = length2 > 0.0 ? std::clamp(-from.dot(edge) / length2, 0.0, 1.0) : 0.0;
      const Vec3 foot = from + share * edge;
      if (foot.squaredNorm() < nearest.squaredNorm()) nearest = foot;
    }
  const double length = nearest.norm();
  if (!(length > kLeastRadiusShare * surface.radius_mm) || !(length > 0.0))
    return std::numeric_limits<double>::infinity();
  const Vec3 out = nearest / length;
  Vec3 normal = out, point = surface.point + surface.radius_mm * out;
  if (surface.kind == SurfaceKind::kCone) {
    normal =
        std::cos(surface.half_angle_rad) * out - std::sin(surface.half_angle_rad) * surface.axis;
    point = surface.point;  // all tangent planes meet in the apex
  }
  return patch.depth_below_plane(normal, point, 0.0);
}

}  // namespace mortise
