#include "common/depth/cells/cover_hollow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/depth/cells/cover_profile.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Holes that are found, and sides of one; what is left out makes the cover larger.
constexpr std::size_t kMostHollows = 12, kMostHollowSides = 32;
// Sides times triangles that are compared, some 0.1 s.
constexpr std::size_t kMostHollowCompared = 20'000'000;
// Planes that are off by less are along the axis.
constexpr double kAlongHollow = 1e-9;
// Of a round side that is not alone: no more than half a turn, but for rounding.
constexpr double kHalfTurn = -1e-6;
// Of a tangent and the plane that goes on from it: an angle of 1e-4, the rounding of a file.
constexpr double kGoesOn = 1.0 - 5e-9;

// The hole that one bore and the faces around it bound together: those that rise from it, or go on.
class Hollow {
 public:
  Hollow(const CoverFaces& faces, const std::vector<ProfileArc>& arcs, std::size_t first)
      : f_(faces), arcs_(arcs), axis_(arcs[first].surface->axis) {
    is_own_.assign(f_.count(), false);
    has_point_.assign(f_.mesh().points_mm.size(), false);
    of_triangle_.assign(f_.count(), kNoArc);
    for (std::size_t i = 0; i < arcs_.size(); ++i)
      for (const std::uint32_t t : arcs_[i].triangles) of_triangle_[t] = i;
    add_arc(first);
  }

  const std::vector<std::size_t>& arcs() const { return own_arcs_; }

  std::optional<LayerVoids> run() {
    find_sides();
    if (own_arcs_.size() + own_planes_.size() < 2 || own_planes_.size() > kMostHollowSides)
      return std::nullopt;
    if (own_arcs_.size() > 1 && !all_smooth()) return std::nullopt;
    set_facets();
    if (facets_.size() * f_.count() > kMostHollowCompared || !is_hole()) return std::nullopt;
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      if (!is_own_[t] && !see(t)) return std::nullopt;
    if (!(std::max(own_.lo, free_.lo) < std::min(own_.hi, free_.hi))) return std::nullopt;
    return voids();
  }

 private:
  static constexpr std::size_t kNoArc = SIZE_MAX;

  // A plane that the hole is above; near: where the mesh has it, far: where its true face may be.
  struct Facet {
    Vec3 n;
    double mesh_mm, true_mm;
  };

  double height(const Vec3& x) const {
    return (x - arcs_[own_arcs_.front()].surface->point).dot(axis_);
  }

  void add_triangle(std::uint32_t t) {
    if (is_own_[t]) return;
    is_own_[t] = true;
    fresh_.push_back(t);
    for (const std::uint32_t p : f_.mesh().triangles[t]) {
      has_point_[p] = true;
      const double z = height(f_.mesh().points_mm[p]);
      own_ = hull(own_, {z, z});
    }
  }
  void add_arc(std::size_t i) {
    if (std::find(own_arcs_.begin(), own_arcs_.end(), i) != own_arcs_.end()) return;
    own_arcs_.push_back(i);
    for (const std::uint32_t t : arcs_[i].triangles) add_triangle(t);
  }
  void add_plane(std::uint32_t face) {
    const PlaneFace& plane = f_.planes.faces[face];
    if (std::fabs(plane.n.dot(axis_)) > kAlongHollow) return;
    for (const auto& [known, border] : own_planes_)
      if (border.has_face[face]) return;
    own_planes_.emplace_back(plane, f_.border(plane.n, plane.c));
    const CoverFaces::Border& border = own_planes_.back().second;
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      if (const std::uint32_t of = f_.planes.face_of_triangle[t];
          of < border.has_face.size() && border.has_face[of])
        add_triangle(t);
  }

  // Over every edge behind which the next face does not fall away from the hole.
  void find_sides() {
    const Topology& topology = f_.body.solid->topology();
    while (!fresh_.empty() && own_planes_.size() <= kMostHollowSides) {
      const std::uint32_t t = fresh_.back();
      fresh_.pop_back();
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t next = topology.neighbor[t][k];
        if (next == Topology::kNone || is_own_[next]) continue;
        const Vec3& n = f_.body.normal(t);
        double rises = kInfinity;
        for (int c = 0; c < 3; ++c)
          rises = std::min(rises, n.dot(f_.mesh().corner(next, c) - f_.mesh().corner(t, k)));
        if (rises < -f_.same_mm) continue;
        if (of_triangle_[next] != kNoArc)
          add_arc(of_triangle_[next]);
        else if (const std::uint32_t face = f_.planes.face_of_triangle[next];
                 face < f_.planes.faces.size())
          add_plane(face);
      }
    }
  }

  // Several round sides are each as far round as their own triangles, so each must go on into the
  // next side: else, moved by its offset, it would be longer.
  bool all_smooth() const {
    for (const std::size_t i : own_arcs_) {
      const Arc& arc = arcs_[i].arc;
      if (arc.whole || arc.cosine < kHalfTurn) return false;
      for (const Vec3& end : {arc.from, arc.to}) {
        bool goes_on_there = false;
        for (const auto& [plane, border] : own_planes_)
          goes_on_there |= -plane.n.dot(end) > kGoesOn;
        for (const std::size_t j : own_arcs_)
          goes_on_there |= j != i && goes_on(arcs_[j].arc, end, kGoesOn);
        if (!goes_on_there) return false;
      }
    }
    return true;
  }

  void set_facets() {
    for (const auto& [plane, border] : own_planes_) facets_.push_back({plane.n, plane.c, plane.c});
    for (const std::size_t i : own_arcs_) {
      const Surface& s = *arcs_[i].surface;
      for (const std::uint32_t t : arcs_[i].triangles) {
        Vec3 n = f_.body.normal(t);
        // A unit vector, or zero of a triangle without an area.
        if (!(n.norm() > 0.5)) continue;
        n = (n - n.dot(axis_) * axis_).normalized();
        double c_mm = kInfinity;
        for (int k = 0; k < 3; ++k) c_mm = std::min(c_mm, n.dot(f_.mesh().corner(t, k)));
        const bool known = std::any_of(facets_.begin(), facets_.end(), [&](const Facet& facet) {
          return facet.n == n && facet.mesh_mm == c_mm;
        });
        if (!known) facets_.push_back({n, c_mm, n.dot(s.point) - s.radius_mm});
      }
    }
  }

  // Its middle is above all of its sides, and outside of the part.
  bool is_hole() const {
    Vec3 middle = Vec3::Zero();
    std::size_t count = 0;
    for (std::size_t p = 0; p < has_point_.size(); ++p)
      if (has_point_[p]) middle += f_.mesh().points_mm[p], ++count;
    middle /= static_cast<double>(count);
    for (const Facet& facet : facets_)
      if (facet.n.dot(middle) <= facet.mesh_mm + f_.same_mm) return false;
    return nearest_surface(*f_.body.solid, middle).depth_mm < -0.0;
  }

  // Cuts a triangle down to what is above all sides. What is left stands at an end of the hole, or
  // there is none.
  bool see(std::uint32_t t) {
    const bool touches = f_.touches(t, has_point_);
    const double bulge_mm =
        f_.planes.face_of_triangle[t] == PlaneFaces::kNone ? f_.bulge_mm(t) : 0.0;
    polygon_ = {f_.mesh().corner(t, 0), f_.mesh().corner(t, 1), f_.mesh().corner(t, 2)};
    for (const Facet& facet : facets_) {
      // Of what ends on the sides the nominal place counts, of all else the largest.
      leave_beyond(polygon_, facet.n,
                   touches ? facet.mesh_mm + f_.same_mm - bulge_mm
                           : facet.true_mm + f_.same_mm - f_.reach_mm(t, facet.n),
                   cut_);
      if (polygon_.empty()) return true;
    }
    Interval z{kInfinity, -kInfinity};
    for (const Vec3& x : polygon_) z = hull(z, {height(x), height(x)});
    if (z.lo >= own_.hi - f_.same_mm) {
      free_.hi = std::min(free_.hi, z.lo);
      return true;
    }
    if (z.hi > own_.lo + f_.same_mm) return false;
    free_.lo = std::max(free_.lo, z.hi);
    return true;
  }

  LayerVoids voids() const {
    LayerVoids voids;
    for (int layer = 0; layer < 2; ++layer) {
      Void& v = voids.of[layer];
      for (const std::size_t i : own_arcs_) {
        VoidWall& wall = v.walls.emplace_back();
        // All heights are above one point.
        const Surface& s = *arcs_[i].surface;
        wall.axis = axis_;
        wall.point = s.point - height(s.point) * axis_;
        wall.r_mm = s.radius_mm - arcs_[i].offsets[layer] - arcs_[i].tilt_mm;
        if (own_arcs_.size() > 1) wall.arc = arcs_[i].arc;
      }
      for (const auto& [plane, border] : own_planes_)
        v.planes.push_back({plane.n, plane.c + border.offsets[layer]});
    }
    close(free_.lo, 1.0, voids);
    close(free_.hi, -1.0, voids);
    return voids;
  }

  // A floor at height z: material below it for sign 1, above for -1.
  void close(double z, double sign, LayerVoids& voids) const {
    if (!std::isfinite(z)) return;
    const Vec3 n = sign * axis_;
    const double c_mm = n.dot(arcs_[own_arcs_.front()].surface->point) + sign * z;
    const LayerOffsets offsets = f_.border(n, c_mm).offsets;
    for (int layer = 0; layer < 2; ++layer) {
      voids.of[layer].planes.push_back({n, c_mm + offsets[layer]});
      for (VoidWall& wall : voids.of[layer].walls)
        (sign > 0.0 ? wall.along_mm.lo : wall.along_mm.hi) = z + sign * offsets[layer];
    }
  }

  const CoverFaces& f_;
  const std::vector<ProfileArc>& arcs_;
  Vec3 axis_;
  std::vector<std::size_t> own_arcs_, of_triangle_;
  std::vector<std::pair<PlaneFace, CoverFaces::Border>> own_planes_;
  std::vector<bool> is_own_, has_point_;
  std::vector<std::uint32_t> fresh_;
  std::vector<Facet> facets_;
  Interval own_{kInfinity, -kInfinity};
  Interval free_{-kInfinity, kInfinity};
  std::vector<Vec3> polygon_, cut_;
};

}  // namespace

std::vector<LayerVoids> find_hollows(const CoverFaces& f) {
  std::vector<LayerVoids> hollows;
  std::vector<const Surface*> seen;
  for (const SurfaceBand::Face& face : f.body.band->faces) {
    const Surface* s = Body::surface_of(face, Layer::kUpper);
    if (s == nullptr || s->kind != SurfaceKind::kCylinder || !s->inward) continue;
    const auto is_same = [&](const Surface* other) {
      return other->point == s->point && other->axis == s->axis && other->radius_mm == s->radius_mm;
    };
    if (std::any_of(seen.begin(), seen.end(), is_same)) continue;
    const std::vector<ProfileArc> arcs = profile_arcs(f, s->axis, true);
    for (std::size_t i = 0; i < arcs.size() && hollows.size() < kMostHollows; ++i) {
      if (!(is_same(arcs[i].surface))) continue;
      Hollow hollow(f, arcs, i);
      if (auto found = hollow.run()) hollows.push_back(std::move(*found));
      for (const std::size_t own : hollow.arcs()) seen.push_back(arcs[own].surface);
    }
  }
  return hollows;
}

}  // namespace mortise
