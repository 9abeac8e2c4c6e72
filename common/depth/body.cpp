#include "common/depth/body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/constants.h"
#include "common/depth/triangles_in.h"

namespace mortise {
namespace {

// Deeper than this many times the largest offset the nearest face less that offset is good enough.
constexpr double kDeepReaches = 20.0;

// Farther outside than this many times the largest offset a point is outside of every layer.
constexpr double kFarReaches = 1.5;

// Two chords of one circle differ by no more than this; and how closely that is asked.
constexpr double kChordMargin = 1.1;

// Planes that differ by less than this share of a triangle's size are one plane.
constexpr double kFlatShare = 1e-9;

// A plane is what its triangles are.
bool is_round(const Surface& surface) {
  return surface.kind != SurfaceKind::kPlane && surface.kind != SurfaceKind::kUnknown;
}

// The way around a corner ends at an open edge, or at one of many triangles; so many planes and
// surfaces may stand beyond.
constexpr std::uint32_t kBeyondEnd = 2;

// A circle of corners is no circle with fewer.
constexpr int kLeastCircle = 3;

// Is an end of a face a circle in a plane across the axis? The mesh is closed there, its corners
// are on the surface, and what ends the face is flat: then the true face ends in that plane as
// well.
class LevelEnd {
 public:
  LevelEnd(const Body& body, std::uint16_t face, bool upper)
      : body_(body),
        face_(face),
        surface_(*body.band->faces[face].surface),
        sign_(upper ? 1.0 : -1.0),
        end_(upper ? body.extent_of(face).hi : -body.extent_of(face).lo),
        off_mm_(std::max(std::fabs(body.band->faces[face].deviation_mm.lo),
                         std::fabs(body.band->faces[face].deviation_mm.hi))),
        flat_mm_(kRoundingFactor * kUnitRoundoff * body.solid->bvh().extent_mm) {}

  bool found() const {
    int circle = 0;
    for (std::uint32_t t = 0; t < body_.mesh->triangles.size(); ++t) {
      if (body_.face_index(t) != face_) continue;
      for (int k = 0; k < 3; ++k) {
        const double a = height(t, k), b = height(t, (k + 1) % 3);
        const bool on_a = is_level(a), on_b = is_level(b);
        const std::uint32_t other = body_.solid->topology().neighbor[t][k];
        const bool border = other == Topology::kNone || body_.face_index(other) != face_;
        if (on_a && on_b) {
          if (!border || other == Topology::kNone || !is_flat(other)) return false;
          ++circle;
        } else if (border && std::max(a, b) > end_ - off_mm_ - flat_mm_) {
          return false;  // between its corners the true border may go higher than the circle
        }
      }
    }
    return circle >= kLeastCircle;
  }

 private:
  double height(std::uint32_t t, int k) const {
    return sign_ * (body_.mesh->corner(t, k) - surface_.point).dot(surface_.axis);
  }
  bool is_level(double height) const { return height >= end_ - flat_mm_; }
  bool is_flat(std::uint32_t t) const {
    for (int k = 0; k < 3; ++k)
      if (std::fabs(height(t, k) - end_) > flat_mm_) return false;
    return true;
  }

  const Body& body_;
  std::uint16_t face_;
  const Surface& surface_;
  double sign_, end_, off_mm_, flat_mm_;
};

// A gap between two triangles that is no more than the rounding of their angles.
constexpr double kNoGap_rad = 1e-9;

// The angles that arcs cover together: all but the widest gap.
FaceArc covered_by(std::vector<Interval> arcs) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  std::sort(arcs.begin(), arcs.end(),
            [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
  double reached = -kTurn;
  for (const Interval& arc : arcs) reached = std::max(reached, arc.hi - kTurn);
  Interval gap{0.0, kNoGap_rad};
  for (const Interval& arc : arcs) {
    if (arc.lo - reached > gap.width()) gap = {reached, arc.lo};
    reached = std::max(reached, arc.hi);
  }
  if (!(gap.width() > kNoGap_rad)) return {};
  return {gap.middle() + std::numbers::pi, 0.5 * (kTurn - gap.width())};
}

// Directions of a torus that a face has, by its triangles.
class TorusArcs {
 public:
  TorusArcs(const Body& body, std::uint16_t face)
      : body_(body),
        face_(face),
        torus_(*body.band->faces[face].surface),
        e1_(torus_.axis.unitOrthogonal()),
        e2_(torus_.axis.cross(e1_)) {
    for (std::uint32_t t = 0; t < body.mesh->triangles.size(); ++t)
      if (body.face_index(t) == face) add(t);
  }

  void tell(FaceEnds& ends) {
    ends.around_axis = covered_by(std::move(turns_));
    ends.around_tube = covered_by(std::move(tubes_));
    ends.level[0] = ends.level[1] = square_;
  }

 private:
  // A triangle spans less than half a turn.
  static Interval arc_of(const std::array<double, 3>& rad) {
    Interval arc{rad[0], rad[0]};
    for (const double a : {rad[1], rad[2]}) {
      const double from = std::remainder(a - rad[0], 2.0 * std::numbers::pi);
      arc = hull(arc, {rad[0] + from, rad[0] + from});
    }
    return arc;
  }

  void add(std::uint32_t t) {
    std::array<double, 3> turn, tube;
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = body_.mesh->corner(t, k) - torus_.point;
      const double z = d.dot(torus_.axis);
      turn[k] = std::atan2(d.dot(e2_), d.dot(e1_));
      tube[k] = std::atan2(z, (d - z * torus_.axis).norm() - torus_.radius_mm);
    }
    turns_.push_back(arc_of(turn));
    tubes_.push_back(arc_of(tube));
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = body_.solid->topology().neighbor[t][k];
      if (other != Topology::kNone && body_.face_index(other) == face_) continue;
      const int next = (k + 1) % 3;
      square_ = square_ && (is_same(turn[k], turn[next]) || is_same(tube[k], tube[next]));
    }
  }
  static bool is_same(double a, double b) {
    return std::fabs(std::remainder(a - b, 2.0 * std::numbers::pi)) <= kNoGap_rad;
  }

  const Body& body_;
  std::uint16_t face_;
  const Surface& torus_;
  Vec3 e1_, e2_;
  std::vector<Interval> turns_, tubes_;
  bool square_ = true;  // its border runs along and across the tube
};

}  // namespace

Body::Body(const Solid& solid_of, const SurfaceBand& band_of)
    : solid(&solid_of),
      band(&band_of),
      mesh(&solid_of.mesh()),
      has_inside(solid_of.has_inside()),
      index_(body_index(solid_of, band_of)) {
  for (const Layer layer : {Layer::kLower, Layer::kUpper})
    for (const SurfaceBand::Face& face : band->faces) {
      const Interval range = offset_range_of(face, layer);
      double& largest = largest_offset_mm[static_cast<int>(layer)];
      largest = std::max({largest, std::fabs(range.lo), std::fabs(range.hi)});
    }
}

namespace {

bool goes_on(const Surface* from, const Surface* to, const Vec3& x) {
  return from != nullptr && to != nullptr &&
         from->outward_normal(x).dot(to->outward_normal(x)) > std::cos(kSharpEdge_rad);
}

// How far a point of a declared surface may be from the triangles that stand for it.
double off_face_mm(const SurfaceBand::Face& face) {
  const Interval& deviation = face.deviation_mm;
  return kChordMargin * std::max(std::fabs(deviation.lo), std::fabs(deviation.hi)) +
         kFlatShare * face.surface->radius_mm;
}

}  // namespace

bool Body::stands_for(std::uint16_t face, const Vec3& x) const {
  const SurfaceBand::Face& f = band->faces[face];
  const Vec3 foot = x - f.surface->signed_distance_mm(x) * f.surface->outward_normal(x);
  // Near its rim the way from the surface to a facet is longer than the facet's deviation.
  const double allowed = 2.0 * off_face_mm(f);
  bool found = false;
  for_each_triangle_in(
      solid->bvh(), Box{foot.array() - allowed, foot.array() + allowed},
      [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
        found = found || (face_index(t) == face &&
                          (nearest_on_triangle(foot, c[0], c[1], c[2]) - foot).norm() <= allowed);
      });
  return found;
}

std::span<const std::uint32_t> Body::sharp_neighbours(std::uint32_t triangle) const {
  const BodyIndex::Range& range = sharp_range(triangle);
  return {index_->sharp.data() + range.first, range.count};
}

const BodyIndex::Range& Body::sharp_range(std::uint32_t triangle) const {
  std::vector<BodyIndex::Range>& ranges = index_->sharp_range;
  if (ranges.empty()) ranges.resize(mesh->triangles.size());
  if (ranges[triangle].first == Topology::kNone) find_sharp_neighbours(triangle);
  return ranges[triangle];
}

void Body::find_sharp_neighbours(std::uint32_t triangle) const {
  std::vector<std::uint32_t>& sharp = index_->sharp;
  const Topology& topology = solid->topology();
  const Vec3 n = normal(triangle);
  const double size = (mesh->corner(triangle, 1) - mesh->corner(triangle, 0)).norm();
  const auto first = static_cast<std::uint32_t>(sharp.size());
  std::uint32_t left_out = 0;
  const auto bounds = [&](std::uint32_t t, const Vec3& normal_t) {
    // A declared surface itself: corners of a face around a bore may lie above the planes of its
    // triangles.
    if (const Surface* surface = surface_of(face(t), Layer::kUpper)) {
      const double chord = std::max(0.0, -face(t).deviation_mm.lo);
      const double allowed = face(t).residual_mm + kChordMargin * chord + kFlatShare * size;
      return surface->stays_below_mm(mesh->corner(triangle, 0), mesh->corner(triangle, 1),
                                     mesh->corner(triangle, 2), allowed);
    }
    for (int k = 0; k < 3; ++k)
      if (normal_t.dot(mesh->corner(triangle, k) - mesh->corner(t, 0)) > kFlatShare * size)
        return false;
    return true;
  };
  const auto known = [&](std::uint32_t t, const Vec3& normal_t) {
    const Surface* surface = surface_of(face(t), Layer::kUpper);
    for (std::size_t i = first; i < sharp.size(); ++i) {
      const Surface* other = surface_of(face(sharp[i]), Layer::kUpper);
      if (surface != nullptr ? surface == other
                             : other == nullptr && face_index(t) == face_index(sharp[i]) &&
                                   normal(sharp[i]).dot(normal_t) > 1.0 - kFlatShare)
        return true;
    }
    return false;
  };
  for (const std::uint32_t point : mesh->triangles[triangle]) {
    std::uint32_t t = triangle;
    for (std::size_t guard = 0; guard < mesh->triangles.size(); ++guard) {
      int k = 0;
      while (k < 2 && mesh->triangles[t][k] != point) ++k;
      t = topology.neighbor[t][k];
      if (t == Topology::kNone) left_out += kBeyondEnd;
      if (t == triangle || t == Topology::kNone) break;
      const Vec3 normal_t = normal(t);
      if (normal_t.dot(n) > std::cos(kSharpEdge_rad) || normal_t.isZero(0.0)) continue;
      // However few triangles stand for it, a declared surface is smooth.
      const Surface* own = surface_of(face(triangle), Layer::kUpper);
      const Surface* other = surface_of(face(t), Layer::kUpper);
      if (face_index(t) == face_index(triangle) && own != nullptr) continue;
      // Nor is one sharp towards another that goes on from it.
      if (goes_on(own, other, mesh->points_mm[point])) continue;
      if (!bounds(t, normal_t) || known(t, normal_t)) continue;
      if (sharp.size() - first < kMostSharp)
        sharp.push_back(t);
      else
        ++left_out;
    }
  }
  index_->sharp_range[triangle] = {first, static_cast<std::uint32_t>(sharp.size() - first),
                                   left_out};
}

const std::vector<std::array<std::int32_t, Bvh::kWidth>>& Body::face_of_child() const {
  if (index_->face_of_child.empty()) {
    index_->face_of_child.resize(solid->bvh().nodes.size());
    find_faces_of_children(solid->bvh().root);
  }
  return index_->face_of_child;
}

const PlaneFaces& Body::plane_faces() const {
  if (!index_->plane_faces)
    index_->plane_faces = std::make_unique<const PlaneFaces>(find_plane_faces(*solid, *band));
  return *index_->plane_faces;
}

std::int32_t Body::find_faces_of_children(std::int32_t child) const {
  const Bvh& bvh = solid->bvh();
  if (child < 0) {
    const Bvh::Leaf& leaf = bvh.leaves[~child];
    const std::int32_t first = face_index(bvh.triangle_order[leaf.first]);
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
      if (face_index(bvh.triangle_order[i]) != first) return kMixed;
    return first;
  }
  const Bvh::Node& node = bvh.nodes[child];
  std::int32_t common = kMixed;
  bool mixed = false;
  for (int k = 0; k < node.count; ++k) {
    const std::int32_t face = find_faces_of_children(node.child[k]);
    index_->face_of_child[child][k] = face;
    if (k == 0) common = face;
    mixed |= face != common;
  }
  return mixed ? kMixed : common;
}

const Surface* Body::surface_of(const SurfaceBand::Face& face, Layer layer) {
  if (layer == Layer::kMesh || !face.surface || !is_round(*face.surface)) return nullptr;
  return &*face.surface;
}

double Body::offset_of(const SurfaceBand::Face& face, Layer layer) {
  if (layer == Layer::kMesh) return 0.0;
  const bool exact = surface_of(face, layer) != nullptr;
  const Interval doubt = exact ? face.doubt_mm() : face.deviation_mm;
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

namespace {

// Declared faces that may be near one point at once; of further ones the triangles are asked.
constexpr int kMostSurfaces = 12;

// A foot this many times as far off its face as the mesh may be is still beside the end of it: on
// the rim of a countersink the way to the facet is longer than its deviation.
constexpr double kBesideFace = 4.0;

// A direction that grazes a facet more than this says nothing of where its offset is met.
constexpr double kLeastFacing = 0.05;

// The declared surfaces near a point, each with the distance of its own foot to the face that
// stands for it.
struct NearSurfaces {
  struct One {
    const SurfaceBand::Face* face;
    const Surface* surface;
    double depth_mm;  // of the surface without offset
    Vec3 foot;
    double off_face2 = std::numeric_limits<double>::infinity();
    double by_triangles_mm = std::numeric_limits<double>::infinity();
  };
  std::array<One, kMostSurfaces> all;
  int count = 0;

  One* of(const SurfaceBand::Face& face, const Surface& surface, const Vec3& x) {
    for (int i = 0; i < count; ++i)
      if (all[i].face == &face) return &all[i];
    if (count == kMostSurfaces) return nullptr;
    One& one = all[count++];
    one.face = &face;
    one.surface = &surface;
    one.depth_mm = -surface.signed_distance_mm(x);
    one.foot = x + one.depth_mm * surface.outward_normal(x);
    return &one;
  }
};

}  // namespace

// Near the edge of two faces the part is where the layers of both have it: the least of all near
// faces. Behind a hollow edge, where either would do, that is less than the truth, never more.
double Body::depth_in(const Vec3& x, const SurfacePoint& nearest, Layer layer) const {
  const double reach = largest_offset_mm[static_cast<int>(layer)];
  if (layer == Layer::kMesh || reach == 0.0) return nearest.depth_mm;
  // Deep inside no face comes nearer than the nearest one less the offsets of both; far outside the
  // sign is known.
  if (nearest.depth_mm > kDeepReaches * reach) return nearest.depth_mm - reach;
  if (nearest.depth_mm < -kFarReaches * reach)
    return nearest.depth_mm + offset_at(nearest.triangle, nearest.point, layer);
  const bool in_mesh = nearest.depth_mm > 0.0;
  const double range = std::fabs(nearest.depth_mm) + 2.0 * reach;
  const Box box{x.array() - range, x.array() + range};
  NearSurfaces surfaces;
  double least = std::numeric_limits<double>::infinity();
  for_each_triangle_in(solid->bvh(), box, [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
    const SurfaceBand::Face& face_t = face(t);
    const Surface* surface = surface_of(face_t, layer);
    NearSurfaces::One* one = surface != nullptr ? surfaces.of(face_t, *surface, x) : nullptr;
    if (one != nullptr)
      one->off_face2 =
          std::min(one->off_face2,
                   (nearest_on_triangle(one->foot, c[0], c[1], c[2]) - one->foot).squaredNorm());
    const double by_triangle = depth_by_triangle(x, t, c, in_mesh, layer);
    if (one != nullptr)
      one->by_triangles_mm = std::min(one->by_triangles_mm, by_triangle);
    else
      least = std::min(least, by_triangle);
  });
  for (int i = 0; i < surfaces.count; ++i) {
    const NearSurfaces::One& one = surfaces.all[i];
    const double on_face = off_face_mm(*one.face);
    const double exact = one.depth_mm + offset_of(*one.face, layer);
    const bool beside = one.off_face2 <= kBesideFace * kBesideFace * on_face * on_face;
    least = std::min(least, beside ? exact : std::max(exact, one.by_triangles_mm));
  }
  // Nothing near: the box was empty by rounding.
  if (!std::isfinite(least)) return nearest.depth_mm - reach;
  return least;
}

// Depth of x below the offset plane of a triangle: along the way to the triangle from inside, along
// its normal from outside.
double Body::depth_by_triangle(const Vec3& x, std::uint32_t t, const std::array<Vec3, 3>& c,
                               bool in_mesh, Layer layer) const {
  const Vec3 foot = nearest_on_triangle(x, c[0], c[1], c[2]);
  const double offset = offset_at(t, foot, layer);
  const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
  const double length = n.norm();
  const double below = length > 0.0 ? n.dot(foot - x) / length : 0.0;
  if (!in_mesh) return length > 0.0 ? below + offset : std::numeric_limits<double>::infinity();
  const double distance = (foot - x).norm();
  if (offset >= 0.0 || !(distance > 0.0)) return distance + offset;
  return distance + offset / std::max(kLeastFacing, below / distance);
}

const FaceEnds& Body::ends_of(std::uint16_t face) const {
  std::vector<FaceEnds>& ends = index_->ends;
  if (ends.empty()) {
    ends.assign(band->faces.size(), {{kInfinity, -kInfinity}});
    for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t) {
      const std::uint16_t f = face_index(t);
      const auto& surface = band->faces[f].surface;
      if (!surface) continue;
      for (int k = 0; k < 3; ++k) {
        const double z = (mesh->corner(t, k) - surface->point).dot(surface->axis);
        ends[f].extent_mm.lo = std::min(ends[f].extent_mm.lo, z);
        ends[f].extent_mm.hi = std::max(ends[f].extent_mm.hi, z);
      }
    }
    const auto faces = static_cast<std::uint16_t>(ends.size());
    for (std::uint16_t f = 0; f < faces; ++f) {
      const auto& surface = band->faces[f].surface;
      if (surface && surface->kind == SurfaceKind::kSphere)
        for (const bool upper : {false, true})
          ends[f].level[upper] = LevelEnd(*this, f, upper).found();
      if (surface && surface->kind == SurfaceKind::kTorus) TorusArcs(*this, f).tell(ends[f]);
    }
  }
  return ends[face];
}

}  // namespace mortise
