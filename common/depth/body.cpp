#include "common/depth/body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.h"

namespace mortise {
namespace {

// Sharp neighbours kept of one triangle; a corner of a machine part has two or three.
constexpr std::size_t kMostSharp = 8;

// Deeper than this many times the largest offset the nearest face less that offset is good enough.
constexpr double kDeepReaches = 20.0;

// Share of a face's deviation by which two ways to measure it may differ over the face.
constexpr double kSecondOrder = 0.1;

// Two chords of one circle differ by no more than this; and how closely that is asked.
constexpr double kChordMargin = 1.1;

// Planes that differ by less than this share of a triangle's size are one plane.
constexpr double kFlatShare = 1e-9;

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

const Interval& Body::extent_of(std::uint16_t face) const {
  if (extents_.empty()) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    extents_.assign(band->faces.size(), Interval{kInfinity, -kInfinity});
    for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t) {
      const std::uint16_t f = face_index(t);
      const auto& surface = band->faces[f].surface;
      if (!surface) continue;
      for (int k = 0; k < 3; ++k) {
        const double z = (mesh->corner(t, k) - surface->point).dot(surface->axis);
        extents_[f].lo = std::min(extents_[f].lo, z);
        extents_[f].hi = std::max(extents_[f].hi, z);
      }
    }
  }
  return extents_[face];
}

std::span<const std::uint32_t> Body::sharp_neighbours(std::uint32_t triangle) const {
  if (sharp_range_.empty()) sharp_range_.resize(mesh->triangles.size());
  if (sharp_range_[triangle].first == Topology::kNone) find_sharp_neighbours(triangle);
  const Range& range = sharp_range_[triangle];
  return {sharp_.data() + range.first, range.count};
}

void Body::find_sharp_neighbours(std::uint32_t triangle) const {
  const Topology& topology = solid->topology();
  const Vec3 n = normal(triangle);
  const double size = (mesh->corner(triangle, 1) - mesh->corner(triangle, 0)).norm();
  const auto first = static_cast<std::uint32_t>(sharp_.size());
  const auto bounds = [&](std::uint32_t t, const Vec3& normal_t) {
    // A declared surface itself: corners of a face around a bore may lie above the planes of its
    // triangles.
    if (const Surface* surface = surface_of(face(t), Layer::kUpper)) {
      const double chord = std::max(0.0, -face(t).deviation_mm.lo);
      const double allowed = face(t).residual_mm + kChordMargin * chord + kFlatShare * size;
      const Vec3 &a = mesh->corner(triangle, 0), &b = mesh->corner(triangle, 1),
                 &c = mesh->corner(triangle, 2);
      const double highest_at_corner =
          std::max({surface->signed_distance_mm(a), surface->signed_distance_mm(b),
                    surface->signed_distance_mm(c)});
      if (highest_at_corner > allowed) return false;
      // Outside of a shaft the distance is convex: corners are enough.
      return !surface->inward ||
             surface->signed_distance_range_mm(a, b, c, (kChordMargin - 1.0) * chord).hi <= allowed;
    }
    for (int k = 0; k < 3; ++k)
      if (normal_t.dot(mesh->corner(triangle, k) - mesh->corner(t, 0)) > kFlatShare * size)
        return false;
    return true;
  };
  const auto known = [&](std::uint32_t t, const Vec3& normal_t) {
    const Surface* surface = surface_of(face(t), Layer::kUpper);
    for (std::size_t i = first; i < sharp_.size(); ++i) {
      const Surface* other = surface_of(face(sharp_[i]), Layer::kUpper);
      if (surface != nullptr ? surface == other
                             : other == nullptr && face_index(t) == face_index(sharp_[i]) &&
                                   normal(sharp_[i]).dot(normal_t) > 1.0 - kFlatShare)
        return true;
    }
    return false;
  };
  for (int corner = 0; corner < 3; ++corner) {
    const std::uint32_t point = mesh->triangles[triangle][corner];
    std::uint32_t t = triangle;
    for (std::size_t guard = 0; guard < mesh->triangles.size(); ++guard) {
      int k = 0;
      while (k < 2 && mesh->triangles[t][k] != point) ++k;
      t = topology.neighbor[t][k];
      if (t == triangle || t == Topology::kNone) break;
      const Vec3 normal_t = normal(t);
      if (normal_t.dot(n) > std::cos(kSharpEdge_rad) || normal_t.isZero(0.0)) continue;
      // However few triangles stand for it, a declared surface is smooth.
      if (face_index(t) == face_index(triangle) && surface_of(face(t), Layer::kUpper) != nullptr)
        continue;
      if (sharp_.size() - first < kMostSharp && bounds(t, normal_t) && !known(t, normal_t))
        sharp_.push_back(t);
    }
  }
  sharp_range_[triangle] = {first, static_cast<std::uint32_t>(sharp_.size() - first)};
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

double Body::depth_in(const Vec3& x, const SurfacePoint& nearest, Layer layer) const {
  if (layer == Layer::kMesh) return nearest.depth_mm;
  double least = nearest.depth_mm + offset_at(nearest.triangle, nearest.point, layer);
  // Over a declared face its own distance is exact; the mesh point's deviation differs from it in
  // second order. Where they differ by more, x lies beyond the face's end.
  const SurfaceBand::Face& at_face = face(nearest.triangle);
  if (const Surface* surface = surface_of(at_face, layer)) {
    const double exact = offset_of(at_face, layer) - surface->signed_distance_mm(x);
    if (std::fabs(exact - least) <= kSecondOrder * at_face.deviation_mm.width())
      least = std::min(least, exact);
  }
  const double reach = largest_offset_mm[static_cast<int>(layer)];
  // Outside the mesh the nearest face decides; deep inside no face comes nearer than the nearest
  // one less the offsets of both.
  if (nearest.depth_mm <= 0.0 || least <= 0.0 || reach == 0.0) return least;
  const double range = nearest.depth_mm + 2.0 * reach;
  if (nearest.depth_mm > kDeepReaches * reach) return std::min(least, nearest.depth_mm - reach);
  const Box box{x.array() - range, x.array() + range};
  for_each_triangle_in(solid->bvh(), box, [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
    const Vec3 foot = nearest_on_triangle(x, c[0], c[1], c[2]);
    least = std::min(least, (foot - x).norm() + offset_at(t, foot, layer));
  });
  return least;
}

}  // namespace mortise
