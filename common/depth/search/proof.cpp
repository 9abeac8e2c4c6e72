#include "common/depth/search/proof.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/check.h"
#include "common/depth/search/facing_tangent.h"
#include "common/depth/search/known_depth.h"
#include "common/depth/search/wall_mean.h"
#include "common/depth/triangles_in.h"

namespace mortise {
namespace {

// Walls kept for covering others, and facets left open: more means that the patch is too large for
// this neighbourhood and is better halved.
constexpr std::size_t kMostWalls = 24, kMostOpen = 96;

// Facets of one hollow corner: normals within 60 degrees of each other.
constexpr double kSameSide = 0.5;

// Cosines of normals of one plane differ from one by less than this.
constexpr double kOnePlane = 1e-9;

using Corners = std::array<Vec3, 3>;
using Facet = ProofScratch::Facet;

// Normal and point of a facet, at the centre of the patch. No normal: a triangle without area.
void set_out(Facet& facet, const Corners& c, const Vec3& center) {
  if (facet.surface == nullptr) {
    const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
    const double length = n.norm();
    if (!(length > 0.0)) return;
    facet.normal = n / length;
    facet.point = c[0];
    return;
  }
  facet.normal = facet.surface->outward_normal(center);
  facet.point = center - facet.surface->signed_distance_mm(center) * facet.normal;
}

// Upper bound of how far a cylinder or cone between two heights rises above a wall, which is a
// plane or a shaft: the face lies within the hull of its end circles.
double highest_above(const Surface& round, const Interval& extent, const Facet& wall) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const double z : {extent.lo, extent.hi}) {
    const Vec3 center = round.point + z * round.axis;
    const double radius =
        round.kind == SurfaceKind::kCone ? z * std::tan(round.half_angle_rad) : round.radius_mm;
    if (wall.surface == nullptr) {
      const double along = wall.normal.dot(round.axis);
      highest = std::max(highest, wall.normal.dot(center - wall.point) +
                                      radius * std::sqrt(std::max(0.0, 1.0 - along * along)));
    } else {
      const Surface& shaft = *wall.surface;
      const Vec3 d = center - shaft.point;
      highest =
          std::max(highest, (d - d.dot(shaft.axis) * shaft.axis).norm() + radius - shaft.radius_mm);
    }
  }
  return highest;
}

// By how much the normal of a hollow surface turns over the patch.
double turn_of(const Surface& surface, const Patch& patch) {
  return std::min(1.0, surface.curvature_bound(patch.center) * patch.radius_mm);
}

// A cylinder or cone lies within the hull of its end circles.
bool has_straight_lines(const Surface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kCone;
}

// What is above a bore is convex; above a hollow torus it is not.
bool is_bore(const Surface& surface) {
  return surface.inward && surface.kind != SurfaceKind::kTorus;
}

// What a tangent or chord of the surface leaves out over the patch.
double concave_bend_mm(const Surface& surface, const Patch& patch) {
  return surface.concave_bend_mm(patch.center,
                                 {patch.points.data(), static_cast<std::size_t>(patch.count)},
                                 patch.thickness());
}

// Does a triangle of k lie in the plane of the wall?
bool is_in_plane(const Body& k, std::uint32_t t, const Facet& wall, double rounding_mm) {
  return k.normal(t).dot(wall.normal) > 1.0 - kOnePlane &&
         std::fabs(wall.normal.dot(k.mesh->corner(t, 0) - wall.point)) <= rounding_mm;
}

bool is_within(const Patch& patch, double reach_mm, const Corners& c) {
  return (nearest_on_triangle(patch.center, c[0], c[1], c[2]) - patch.center).norm() <=
         patch.radius_mm + reach_mm;
}

class Neighbourhood {
 public:
  Neighbourhood(const DepthProof& proof, const Patch& patch, ProofScratch& scratch)
      : proof_(proof),
        patch_(patch),
        scratch_(scratch),
        k_(*proof.k),
        up_(proof.at_center.face_normal) {
    scratch_.walls.clear();
    scratch_.open.clear();
    scratch_.near.clear();
  }

  bool holds_off() {
    const double u = proof_.limit_mm;
    const double reach = reach_ = std::fabs(u) +
                                  k_.largest_offset_mm[static_cast<int>(proof_.layer)] +
                                  patch_.thickness() + proof_.rounding_mm;
    Box box;
    for (int i = 0; i < patch_.count; ++i) box.add(patch_.points[i]);
    Slab slab{patch_.normal, {kInfinity, -kInfinity}};
    for (int i = 0; i < patch_.count; ++i) {
      const double h = slab.normal.dot(patch_.points[i]);
      slab.between_mm = hull(slab.between_mm, {h - reach, h + reach});
    }
    bool failed = false;
    const auto visit = [&](std::uint32_t t, const Corners& c) {
      if (scratch_.near.size() <= kMostOpen) scratch_.near.push_back({t, c});
      failed = !take(t, c);
      return !failed;
    };
    const std::uint32_t first = proof_.at_center.triangle;
    // The facet nearest to the centre first: most others lie below it.
    nearest_ = {k_.mesh->corner(first, 0), k_.mesh->corner(first, 1), k_.mesh->corner(first, 2)};
    const bool nearest_counts = std::fabs(proof_.at_center.depth_mm) <= reach + patch_.radius_mm;
    if (nearest_counts && !take(first, nearest_)) return false;
    for_each_triangle_in(k_.solid->bvh(), box.grown(reach), slab, visit);
    if (failed) return false;
    // The whole patch is on the centre's side, and not deeper than u.
    if (scratch_.near.empty()) return true;
    if (all_covered() && (u <= 0.0 || void_above_walls())) return true;
    if (u > 0.0 && leave_between_open_facets()) return true;
    return nearest_counts && below_two_walls();
  }

 private:
  bool all_covered() const {
    for (const ProofScratch::Near& open : scratch_.open)
      if (!covered(open.triangle, open.corners)) return false;
    return true;
  }

  // In a hollow corner the way out leads between its facets: the same proof with m their mean.
  bool leave_between_open_facets() {
    if (scratch_.near.size() > kMostOpen) return false;
    Vec3 sum = up_;
    for (const ProofScratch::Near& open : scratch_.open) {
      const Vec3 n = k_.normal(open.triangle);
      if (n.dot(up_) > kSameSide && n.dot(up_) < 1.0 - kOnePlane) sum += n;
    }
    if (sum.isApprox(up_)) return false;
    up_ = sum.normalized();
    scratch_.walls.clear();
    scratch_.open.clear();
    for (const ProofScratch::Near& near : scratch_.near)
      if (!take(near.triangle, near.corners)) return false;
    return all_covered() && void_above_walls();
  }

  // False: too much is open.
  bool take(std::uint32_t t, const Corners& c) {
    if (covered(t, c) || add_wall(t, c)) return true;
    // A neighbour that is moved inward cuts it short beyond the end of its own triangles.
    if (proof_.layer != Layer::kMesh)
      for (const std::uint32_t n : k_.sharp_neighbours(t))
        if (Body::offset_of(k_.face(n), proof_.layer) < 0.0 &&
            add_wall(n, {k_.mesh->corner(n, 0), k_.mesh->corner(n, 1), k_.mesh->corner(n, 2)}) &&
            covered(t, c))
          return true;
    if (scratch_.open.size() >= kMostOpen) return false;
    scratch_.open.push_back({t, c});
    return true;
  }

  // Does the facet hold the patch off? Then it is kept as a wall. All triangles of a declared face
  // say the same.
  bool add_wall(std::uint32_t t, const Corners& c) {
    Facet facet;
    facet.triangle = t;
    const SurfaceBand::Face& face = k_.face(t);
    if (&face == open_face_) return false;
    facet.surface = Body::surface_of(face, proof_.layer);
    facet.offset_mm = Body::offset_of(face, proof_.layer);
    const KnownDepth depth = depth_below(facet, c);
    if (facet.normal.isZero(0.0)) return true;  // without area: its neighbours are asked
    // The depth below a declared surface is a distance already: by itself it needs no direction.
    const bool moved = proof_.limit_mm > 0.0 && facet.surface == nullptr;
    const double along = moved ? facet.normal.dot(up_) : 1.0;
    facet.slack_mm = proof_.limit_mm * along - depth.continued_mm;
    if (facet.slack_mm < -proof_.rounding_mm && depth.face_mm < depth.continued_mm) {
      facet.covers_along_mm = depth.along_mm;
      facet.slack_mm = proof_.limit_mm * along - depth.face_mm;
    }
    if (facet.slack_mm < -proof_.rounding_mm) {
      if (facet.surface != nullptr) open_face_ = &face;
      return false;
    }
    if (scratch_.walls.size() < kMostWalls) scratch_.walls.push_back(facet);
    return true;
  }

  // Largest depth of the patch below a facet; sets its normal and point.
  KnownDepth depth_below(Facet& facet, const Corners& c) const {
    const double deepest = depth_below_surface(facet, c);
    KnownDepth known;
    if (facet.surface != nullptr && proof_.known != nullptr && !proof_.known->rows.empty())
      known = known_depth(proof_, patch_, facet.triangle);
    known.face_mm = std::min(known.face_mm, deepest);
    known.continued_mm = std::min(known.continued_mm, deepest);
    return known;
  }

  // By where the patch is and the facet's surface continued.
  double depth_below_surface(Facet& facet, const Corners& c) const {
    set_out(facet, c, patch_.center);
    if (facet.normal.isZero(0.0)) return 0.0;
    if (facet.surface == nullptr)
      return facet.offset_mm + patch_.depth_below_plane(facet.normal, facet.point, 0.0);
    const Surface& surface = *facet.surface;
    double deepest = -std::numeric_limits<double>::infinity();
    const double bend_mm = concave_bend_mm(surface, patch_);
    if (surface.inward) {  // the distance is convex, but for that bend
      for (int i = 0; i < patch_.count; ++i)
        deepest = std::max(deepest, -surface.signed_distance_mm(patch_.points[i]));
      deepest += patch_.beyond(facet.normal, turn_of(surface, patch_)) + bend_mm;
    } else {  // it lies below each of its tangent planes
      deepest = patch_.depth_below_plane(facet.normal, facet.point, 0.0) + bend_mm;
      if (deepest + facet.offset_mm > std::min(0.0, proof_.limit_mm))
        deepest = std::min(deepest, depth_below_facing_tangent(patch_, surface));
    }
    return deepest + facet.offset_mm;
  }

  bool covered(std::uint32_t t, const Corners& c) const {
    for (const Facet& wall : scratch_.walls)
      if (below(t, c, wall)) return true;
    return false;
  }

  bool below(std::uint32_t t, const Corners& c, const Facet& wall) const {
    if (!is_along(t, c, wall)) return false;
    return triangle_below(t, c, wall) || round_face_below(t, wall) || cut_back(t, wall);
  }

  // Is the facet where the wall is one?
  bool is_along(std::uint32_t t, const Corners& c, const Facet& wall) const {
    const Interval& along = wall.covers_along_mm;
    if (wall.surface == nullptr || !std::isfinite(along.lo) ||
        Body::surface_of(k_.face(t), proof_.layer) == wall.surface)
      return true;
    for (const Vec3& x : c) {
      const double z = (x - wall.surface->point).dot(wall.surface->axis);
      if (z < along.lo - proof_.rounding_mm || z > along.hi + proof_.rounding_mm) return false;
    }
    return true;
  }

  // A facet that meets the wall at a sharp edge ends on the wall's own layer: where that lies
  // deeper than the mesh, so does the end of the facet.
  bool cut_back(std::uint32_t t, const Facet& wall) const {
    if (wall.offset_mm >= 0.0 || wall.slack_mm < -proof_.rounding_mm) return false;
    const std::uint16_t face = k_.face_index(wall.triangle);
    for (const std::uint32_t other : k_.sharp_neighbours(t)) {
      if (k_.face_index(other) != face) continue;
      if (wall.surface != nullptr || other == wall.triangle ||
          is_in_plane(k_, other, wall, proof_.rounding_mm))
        return true;
    }
    return false;
  }

  // The true surface of a round face is below a plane or a shaft when its end circles are.
  bool round_face_below(std::uint32_t t, const Facet& wall) const {
    const SurfaceBand::Face& face = k_.face(t);
    const Surface* round = Body::surface_of(face, proof_.layer);
    if (round == nullptr || round->inward || !has_straight_lines(*round)) return false;
    const Surface* shaft = wall.surface;
    if (shaft != nullptr && (shaft->inward || shaft->kind != SurfaceKind::kCylinder)) return false;
    const Interval& extent = k_.extent_of(k_.face_index(t));
    if (round->kind == SurfaceKind::kCone && !(extent.lo >= 0.0)) return false;
    const double highest = highest_above(*round, extent, wall);
    const double rise = std::max(0.0, Body::offset_of(face, proof_.layer) - wall.offset_mm);
    return highest + rise <= wall.slack_mm + proof_.rounding_mm;
  }

  bool triangle_below(std::uint32_t t, const Corners& c, const Facet& wall) const {
    const SurfaceBand::Face& face = k_.face(t);
    const Surface* own = Body::surface_of(face, proof_.layer);
    if (wall.surface != nullptr && own == wall.surface) return true;
    // A surface that goes on from the wall's is a wall itself: its offset counts whole, and its
    // triangles end on no chord of the other.
    if (wall.surface != nullptr && own != nullptr &&
        own->outward_normal(c[0]).dot(wall.surface->outward_normal(c[0])) >
            std::cos(kSharpEdge_rad))
      return false;
    double highest = -std::numeric_limits<double>::infinity();
    double allowed = wall.slack_mm + proof_.rounding_mm;
    if (wall.surface == nullptr) {
      for (const Vec3& x : c) highest = std::max(highest, wall.normal.dot(x - wall.point));
    } else {
      for (const Vec3& x : c) highest = std::max(highest, wall.surface->signed_distance_mm(x));
      // Faces that end on a bore end on its true circle; their triangles end on chords of it.
      const double chord = std::max(0.0, -k_.face(wall.triangle).deviation_mm.lo);
      allowed += chord;
      const bool convex = !wall.surface->inward && wall.surface->kind != SurfaceKind::kTorus;
      if (!convex && proof_.layer != Layer::kMesh) {
        const double rise = rise_above(t, c, wall);
        return highest + rise <= allowed &&
               wall.surface->stays_below_mm(c[0], c[1], c[2], allowed - rise);
      }
    }
    if (highest > allowed) return false;
    return proof_.layer == Layer::kMesh || highest + rise_above(t, c, wall) <= allowed;
  }

  // By how much the layer moves a triangle more than a wall, along the wall's normal.
  double rise_above(std::uint32_t t, const Corners& c, const Facet& wall) const {
    const double rise = Body::offset_range_of(k_.face(t), proof_.layer).hi - wall.offset_mm;
    if (rise <= 0.0) return 0.0;
    const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
    const double length = n.norm();
    return rise * (length > 0.0 ? std::max(0.0, n.dot(wall.normal) / length) : 1.0);
  }

  // The plane or bore of a triangle, when all near facets lie below it.
  std::optional<ConvexWall> wall_over_all(std::uint32_t t, const Corners& c) const {
    Facet facet;
    facet.triangle = t;
    facet.surface = Body::surface_of(k_.face(t), proof_.layer);
    if (facet.surface != nullptr && !is_bore(*facet.surface)) return std::nullopt;
    facet.offset_mm = Body::offset_of(k_.face(t), proof_.layer);
    set_out(facet, c, patch_.center);
    if (facet.normal.isZero(0.0)) return std::nullopt;
    for (const ProofScratch::Near& near : scratch_.near)
      if (!below(near.triangle, near.corners, facet)) return std::nullopt;
    const double turn_rad = facet.surface != nullptr ? turn_of(*facet.surface, patch_) : 0.0;
    return ConvexWall{facet.surface, facet.normal, facet.point, facet.offset_mm, turn_rad};
  }

  bool below_two_walls() const {
    if (scratch_.near.size() > kMostOpen) return false;
    const auto first = wall_over_all(proof_.at_center.triangle, nearest_);
    if (!first) return false;
    const Surface* asked = first->surface;
    for (const ProofScratch::Near& near : scratch_.near) {
      if (near.triangle == proof_.at_center.triangle) continue;
      const Surface* surface = Body::surface_of(k_.face(near.triangle), proof_.layer);
      if (surface != nullptr && surface == asked) continue;  // another triangle of the same bore
      // Where a point has to leave k, the wall that it leaves by must be there.
      if (proof_.limit_mm > 0.0 && !is_within(patch_, reach_, near.corners)) continue;
      const auto second = wall_over_all(near.triangle, near.corners);
      if (second && mean_keeps_off(*first, *second, patch_, proof_.limit_mm)) return true;
      if (surface != nullptr) asked = surface;
    }
    return false;
  }

  // Is the space above all walls empty of k? Its rim at the nearest point is, when no wall rises
  // there; else one point of the moved patch is asked.
  bool void_above_walls() const {
    const double allowance =
        k_.largest_offset_mm[static_cast<int>(proof_.layer)] + proof_.rounding_mm;
    bool nearest_is_wall = false, hidden = false;
    for (const Facet& wall : scratch_.walls) {
      nearest_is_wall |= wall.triangle == proof_.at_center.triangle;
      const double height = wall.surface == nullptr
                                ? wall.normal.dot(proof_.at_center.point - wall.point)
                                : wall.surface->signed_distance_mm(proof_.at_center.point);
      hidden |= height < -allowance;
    }
    if (nearest_is_wall && !hidden) return true;
    const Vec3 moved = patch_.center + (proof_.limit_mm + patch_.thickness()) * up_;
    return nearest_surface(*k_.solid, moved).depth_mm <= allowance + patch_.thickness();
  }

  const DepthProof& proof_;
  const Patch& patch_;
  ProofScratch& scratch_;
  const Body& k_;
  Vec3 up_;
  Corners nearest_;
  double reach_ = 0.0;
  const SurfaceBand::Face* open_face_ = nullptr;  // the declared one that held nothing off last
};

}  // namespace

bool depth_at_most(const DepthProof& proof, const Patch& patch, ProofScratch& scratch) {
  MORTISE_CHECK(proof.s != nullptr && proof.k != nullptr && patch.count > 0 &&
                    !std::isnan(proof.limit_mm) && std::isfinite(patch.radius_mm),
                "a proof is of a patch of one part and a depth in the other");
  const double most = proof.limit_mm + proof.rounding_mm;
  // depth_in may say too little; this deep inside the mesh no offset reaches.
  if (proof.at_center.depth_mm - proof.k->largest_offset_mm[static_cast<int>(proof.layer)] > most)
    return false;
  const double center_mm = proof.center_depth_mm
                               ? *proof.center_depth_mm
                               : proof.k->depth_in(patch.center, proof.at_center, proof.layer);
  if (center_mm > most) return false;
  return Neighbourhood(proof, patch, scratch).holds_off();
}

}  // namespace mortise
