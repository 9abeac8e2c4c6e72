#include "common/depth/body.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Torus faces are bounded by their triangles and the band's deviation: the distance to a torus is
// not convex.
bool has_convex_distance(const Surface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kCone ||
         surface.kind == SurfaceKind::kSphere;
}

}  // namespace

Body::Body(const Solid& solid_of, const SurfaceBand& band_of)
    : solid(&solid_of),
      band(&band_of),
      mesh(&solid_of.mesh()),
      has_inside(solid_of.topology().closed()) {
  for (const Layer layer : {Layer::kLower, Layer::kUpper})
    for (const SurfaceBand::Face& face : band->faces) {
      const Interval range = offset_range_of(face, layer);
      double& largest = largest_offset_mm[static_cast<int>(layer)];
      largest = std::max({largest, std::fabs(range.lo), std::fabs(range.hi)});
    }
}

Vec3 Body::normal(std::uint32_t triangle) const {
  const Vec3 n = (mesh->corner(triangle, 1) - mesh->corner(triangle, 0))
                     .cross(mesh->corner(triangle, 2) - mesh->corner(triangle, 0));
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : Vec3::Zero();
}

const Surface* Body::surface_of(const SurfaceBand::Face& face, Layer layer) {
  if (layer == Layer::kMesh || !face.surface || !has_convex_distance(*face.surface)) return nullptr;
  return &*face.surface;
}

double Body::offset_of(const SurfaceBand::Face& face, Layer layer) {
  if (layer == Layer::kMesh) return 0.0;
  const bool exact = surface_of(face, layer) != nullptr;
  const Interval doubt = exact ? Interval{-face.residual_mm, face.residual_mm} : face.deviation_mm;
  return layer == Layer::kLower ? doubt.lo + face.tolerance_mm.lo : doubt.hi + face.tolerance_mm.hi;
}

Interval Body::offset_range_of(const SurfaceBand::Face& face, Layer layer) {
  const double offset = offset_of(face, layer);
  if (surface_of(face, layer) == nullptr) return {offset, offset};
  return face.deviation_mm + Interval{offset, offset};
}

double Body::offset_at(std::uint32_t triangle, const Vec3& x, Layer layer) const {
  if (layer == Layer::kMesh) return 0.0;
  const SurfaceBand::Face& f = face(triangle);
  const Surface* surface = surface_of(f, layer);
  return offset_of(f, layer) - (surface != nullptr ? surface->signed_distance_mm(x) : 0.0);
}

double Body::certain_depth(const Vec3& x) const {
  const SurfacePoint nearest = nearest_surface(*solid, x);
  const double at_nearest = depth_at(nearest, Layer::kLower);
  if (nearest.depth_mm <= 0.0 || at_nearest <= 0.0) return at_nearest;
  // Inside the mesh: a face farther away may come nearer by its own lower offset.
  const double reach = largest_offset_mm[static_cast<int>(Layer::kLower)];
  if (nearest.depth_mm > 2.0 * reach) return nearest.depth_mm - reach;
  double least = at_nearest;
  const double range = nearest.depth_mm + 2.0 * reach;
  const Box box{x.array() - range, x.array() + range};
  for_each_triangle_in(solid->bvh(), box, [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
    const Vec3 foot = nearest_on_triangle(x, c[0], c[1], c[2]);
    least = std::min(least, (foot - x).norm() + offset_at(t, foot, Layer::kLower));
  });
  return least;
}

}  // namespace mortise
