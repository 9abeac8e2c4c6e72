#include "common/geometry/recognition/finish.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "common/base/constants.h"
#include "common/geometry/recognition/names.h"
#include "common/geometry/recognition/surface_fit.h"

namespace mortise {
namespace {

// An edge that would hide this many times the chord error that the part shows elsewhere is an edge
// of the part, not of its tessellation.
constexpr double kEdgeOfThePart = 1.5;
// Neighbouring steps of a curve are about as wide as each other.
constexpr double kUnlikeWidths = 3.0;
// Where no curve shows a chord error: a part of the mesh radius no tessellation leaves.
constexpr double kCoarsestShare = 0.02;

// Pieces of one surface may be joined by a fit as loose as this.
constexpr double kLoosestShare = 4e-4;

constexpr std::int32_t kNobody = -1;

struct Edge {
  std::uint32_t triangle = 0, other = 0;
  int k = 0;
};

// A smooth edge may hide (w/2) tan(phi/4) under it, w the wider of both facets (geometry/README.md,
// section 2).
double hidden_mm(double width_mm, double angle_rad) {
  return 0.5 * width_mm * std::tan(0.25 * angle_rad);
}

bool alike(const Surface& a, const Surface& b, double share) {
  if (a.kind != b.kind || a.inward != b.inward) return false;
  const double size = std::max(a.radius_mm, b.radius_mm);
  // A milliradian is what facets of one cone leave between two fits of it.
  return a.kind == SurfaceKind::kCone
             ? std::fabs(a.half_angle_rad - b.half_angle_rad) < 1e-3
             : std::fabs(a.radius_mm - b.radius_mm) <= 4.0 * share * size + 1e-6 * size &&
                   std::fabs(a.tube_radius_mm - b.tube_radius_mm) <=
                       1e-3 * (a.tube_radius_mm + b.tube_radius_mm);
}

// Cheap: could both be one surface?
bool near_axis(const Surface& a, const Surface& b) {
  if (a.kind != b.kind) return false;
  const double size = std::max(a.radius_mm, 1e-6 * (a.point - b.point).norm());
  const Vec3 d = b.point - a.point;
  // Only who is asked at all: alike() and a fit of both decide. So these are wide.
  if (a.kind == SurfaceKind::kSphere) return d.norm() <= 0.01 * size;
  if (a.axis.cross(b.axis).norm() > 0.02) return false;
  if (a.kind == SurfaceKind::kCone) return true;
  return (d - d.dot(a.axis) * a.axis).norm() <= 0.05 * size;
}

// The point in the middle of the extent and an axis whose largest component is positive: the same
// for every tessellation of a part.
void make_canonical(Surface& s, Interval& along) {
  if (s.kind == SurfaceKind::kCylinder) {
    const double middle = along.middle();
    s.point += middle * s.axis;
    along = {along.lo - middle, along.hi - middle};
  }
  if (s.kind == SurfaceKind::kCone || s.kind == SurfaceKind::kPlane) return;
  Eigen::Index largest = 0;
  s.axis.cwiseAbs().maxCoeff(&largest);
  if (s.kind == SurfaceKind::kSphere) {
    s.axis = Vec3::UnitZ();
  } else if (s.axis[largest] < 0.0) {
    s.axis = -s.axis;
    along = -along;
  }
}

class Finisher {
 public:
  Finisher(const Solid& solid, const Facets& facets, RegionGrower& grower,
           std::vector<Region> regions)
      : solid_(solid),
        mesh_(solid.mesh()),
        facets_(facets),
        grower_(grower),
        regions_(std::move(regions)) {}

  Recognition run(bool planes) {
    join_pieces();
    measure();
    own();
    drop_doubtful_rows();
    emit_curved();
    if (planes) emit_planes();
    name_features(out_);
    for (const Feature& f : out_.features) out_.triangles_recognized += f.triangles.size();
    out_.triangles_left = mesh_.triangles.size() - out_.triangles_recognized;
    return std::move(out_);
  }

 private:
  // 1. one surface in pieces
  bool joined(Region& into, const Region& piece) {
    // Noise may have split what one looser fit holds together.
    const double share = std::max({into.share, piece.share, kLoosestShare});
    if (!alike(into.surface, piece.surface, share)) return false;
    if (into.surface.kind == SurfaceKind::kCylinder || into.surface.kind == SurfaceKind::kCone) {
      // About the same stretch of the axis, else they are two features that happen to be alike.
      const Interval a = extent_along_mm(mesh_, into.surface, into.triangles);
      const Interval b = extent_along_mm(mesh_, into.surface, piece.triangles);
      // Pieces of one bore share most of its length; a tenth is a rim that both touch.
      if (std::min(a.hi, b.hi) - std::max(a.lo, b.lo) <= 0.1 * std::min(a.width(), b.width()))
        return false;
    }
    Region both = into;
    both.share = share;
    both.triangles.insert(both.triangles.end(), piece.triangles.begin(), piece.triangles.end());
    std::sort(both.triangles.begin(), both.triangles.end());
    if (!grower_.settle(both)) return false;
    both.share = std::max(into.share, piece.share);
    into = std::move(both);
    return true;
  }

  void join_pieces() {
    std::vector<std::size_t> order(regions_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto size_of = [&](std::size_t i) {
      const Surface& s = regions_[i].surface;
      return std::tuple(s.kind, s.inward, s.radius_mm + s.half_angle_rad);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size_of(a) < size_of(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      Region& into = regions_[order[i]];
      if (into.triangles.empty()) continue;
      const double size = std::get<2>(size_of(order[i]));
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        Region& piece = regions_[order[j]];
        if (std::get<2>(size_of(order[j])) > size * (1.0 + 2e-3) + 1e-3) break;
        if (piece.triangles.empty() || !near_axis(into.surface, piece.surface)) continue;
        if (joined(into, piece)) piece.triangles.clear();
      }
    }
    std::erase_if(regions_, [](const Region& r) { return r.triangles.empty(); });
  }

  // 2. what they show
  void measure() {
    measures_.clear();
    for (const Region& r : regions_) {
      measures_.push_back(measure_region(mesh_, r.surface, r.triangles));
      chord_mm_.push_back(chord_error_mm(mesh_, r.surface, r.triangles));
      largest_chord_mm_ = std::max(largest_chord_mm_, chord_mm_.back());
    }
  }

  void own() {
    owner_.assign(mesh_.triangles.size(), kNobody);
    for (std::size_t i = 0; i < regions_.size(); ++i)
      for (const std::uint32_t t : regions_[i].triangles) owner_[t] = static_cast<std::int32_t>(i);
  }

  // 3. a row of facets that goes on smoothly may be a step of a curve

  double width_across(std::uint32_t t, int k) const {
    const std::uint32_t f = facets_.of_triangle[t];
    const double edge = (mesh_.corner(t, (k + 1) % 3) - mesh_.corner(t, k)).norm();
    const auto triangles = facets_.triangles(f);
    const Vec3 along = (mesh_.corner(t, (k + 1) % 3) - mesh_.corner(t, k)) / edge;
    const Vec3 across = facets_.normal[f].cross(along);
    double width = 0.0;
    for (const std::uint32_t other : triangles)
      for (int c = 0; c < 3; ++c)
        width =
            std::max(width, std::fabs((mesh_.corner(other, c) - mesh_.corner(t, k)).dot(across)));
    return width;
  }

  // Could the surface pass smoothly over this edge, at the chord error that is usual here?
  bool may_be_step(const Edge& e, double chord_mm) const {
    const std::uint32_t f = facets_.of_triangle[e.triangle], g = facets_.of_triangle[e.other];
    if (f == g || !facets_.reliable[f] || !facets_.reliable[g]) return false;
    const double angle = facets_.angle_rad(f, g);
    if (angle > kSmoothEdge_rad) return false;
    int back = 0;
    for (int k = 0; k < 3; ++k)
      if (solid_.topology().neighbor[e.other][k] == e.triangle) back = k;
    const double a = width_across(e.triangle, e.k), b = width_across(e.other, back);
    return std::max(a, b) <= kUnlikeWidths * std::min(a, b) &&
           hidden_mm(std::max(a, b), angle) <= kEdgeOfThePart * chord_mm;
  }

  bool row(std::int32_t i) const {
    const SurfaceKind kind = regions_[static_cast<std::size_t>(i)].surface.kind;
    return (kind == SurfaceKind::kCone || kind == SurfaceKind::kCylinder) &&
           measures_[static_cast<std::size_t>(i)].one_row;
  }

  // All corners of the row lie on the ball or torus beside it: it may be a part of that, however
  // sharp the edge between them.
  bool lies_on_neighbour(const Region& row, std::int32_t neighbour) const {
    const Region& other = regions_[static_cast<std::size_t>(neighbour)];
    if (other.surface.kind != SurfaceKind::kSphere && other.surface.kind != SurfaceKind::kTorus)
      return false;
    return std::all_of(row.triangles.begin(), row.triangles.end(), [&](std::uint32_t t) {
      for (int k = 0; k < 3; ++k)
        if (std::fabs(other.surface.signed_distance_mm(mesh_.corner(t, k))) > other.allowed_mm)
          return false;
      return true;
    });
  }

  bool doubtful(std::int32_t i) const {
    const Region& r = regions_[static_cast<std::size_t>(i)];
    const Interval along = measures_[static_cast<std::size_t>(i)].along_mm;
    bool low = false, high = false;
    for (const std::uint32_t t : r.triangles)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t other = solid_.topology().neighbor[t][k];
        if (other == Topology::kNone || owner_[other] == i) continue;
        if (owner_[other] != kNobody && !row(owner_[other])) {
          if (lies_on_neighbour(r, owner_[other])) return true;
          continue;
        }
        if (owner_[other] == kNobody && facets_.triangles(facets_.of_triangle[other]).size() > 64)
          continue;
        if (!may_be_step({t, other, k}, chord_mm_[static_cast<std::size_t>(i)])) continue;
        const Vec3 middle = 0.5 * (mesh_.corner(t, k) + mesh_.corner(t, (k + 1) % 3));
        const double z = (middle - r.surface.point).dot(r.surface.axis);
        (z < along.middle() ? low : high) = true;
      }
    return r.surface.kind == SurfaceKind::kCone ? low || high : low && high;
  }

  void drop_doubtful_rows() {
    for (bool changed = true; changed;) {
      std::vector<std::int32_t> gone;
      for (std::int32_t i = 0; i < static_cast<std::int32_t>(regions_.size()); ++i)
        if (!regions_[static_cast<std::size_t>(i)].triangles.empty() && row(i) && doubtful(i))
          gone.push_back(i);
      for (const std::int32_t i : gone) {
        for (const std::uint32_t t : regions_[static_cast<std::size_t>(i)].triangles)
          owner_[t] = kNobody;
        regions_[static_cast<std::size_t>(i)].triangles.clear();
        ++out_.doubtful_rows;
      }
      changed = !gone.empty();
    }
  }

  // 4. features
  double area_of(const std::vector<std::uint32_t>& triangles) const {
    double area = 0.0;
    for (const std::uint32_t t : triangles)
      area += 0.5 * (mesh_.corner(t, 1) - mesh_.corner(t, 0))
                        .cross(mesh_.corner(t, 2) - mesh_.corner(t, 0))
                        .norm();
    return area;
  }

  std::uint32_t facet_count(const std::vector<std::uint32_t>& triangles) const {
    std::vector<std::uint32_t> ids;
    for (const std::uint32_t t : triangles) ids.push_back(facets_.of_triangle[t]);
    std::sort(ids.begin(), ids.end());
    return static_cast<std::uint32_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
  }

  void emit_curved() {
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      Region& r = regions_[i];
      if (r.triangles.empty()) continue;
      FeatureMeasure m;
      const bool sphere = r.surface.kind == SurfaceKind::kSphere;
      m.facets = sphere ? facet_count(r.triangles) : measures_[i].steps;
      m.arc_rad = measures_[i].arc_rad;
      m.along_mm = measures_[i].along_mm;
      m.chord_error_mm = chord_mm_[i];
      m.area_mm2 = area_of(r.triangles);
      make_canonical(r.surface, m.along_mm);
      if (sphere) {
        m.along_mm = {r.surface.radius_mm, -r.surface.radius_mm};
        for (const std::uint32_t t : r.triangles)
          for (int k = 0; k < 3; ++k) {
            const double z = mesh_.corner(t, k).z() - r.surface.point.z();
            m.along_mm = {std::min(m.along_mm.lo, z), std::max(m.along_mm.hi, z)};
          }
      }
      Feature feature;
      feature.surface = r.surface;
      feature.grade = DeviationGrade::kRecognizedFeature;
      feature.origin = FeatureOrigin::kRecognized;
      feature.residual_mm = r.residual_mm;
      out_.largest_residual_share = std::max(
          out_.largest_residual_share, r.residual_mm / size_mm(r.surface, mesh_, r.triangles));
      feature.triangles = std::move(r.triangles);
      out_.features.push_back(std::move(feature));
      out_.measures.push_back(m);
    }
  }

  // 5. planes: flat facets all of whose edges are edges

  bool plane(std::uint32_t f) const {
    const double chord =
        largest_chord_mm_ > 0.0 ? largest_chord_mm_ : kCoarsestShare * solid_.sphere().radius_mm;
    for (const std::uint32_t t : facets_.triangles(f)) {
      if (owner_[t] != kNobody) return false;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t other = solid_.topology().neighbor[t][k];
        if (other == Topology::kNone || owner_[other] != kNobody) continue;
        if (may_be_step({t, other, k}, chord)) return false;
      }
    }
    return true;
  }

  void emit_planes() {
    for (std::uint32_t f = 0; f < facets_.count(); ++f) {
      const auto triangles = facets_.triangles(f);
      if (!facets_.reliable[f] || owner_[triangles.front()] != kNobody) continue;
      if (!plane(f)) {
        ++out_.doubtful_planes;
        continue;
      }
      Feature feature;
      feature.triangles.assign(triangles.begin(), triangles.end());
      feature.grade = DeviationGrade::kPlanar;
      feature.origin = FeatureOrigin::kRecognized;
      Surface& s = feature.surface;
      s.kind = SurfaceKind::kPlane;
      s.axis = facets_.normal[f];
      const std::vector<Vec3> points = grower_.points_of(triangles);
      for (const Vec3& x : points) s.point += x / static_cast<double>(points.size());
      feature.residual_mm = residual_of(s, points);
      FeatureMeasure m;
      m.facets = 1;
      m.area_mm2 = facets_.area_mm2[f];
      m.chord_error_mm = feature.residual_mm;
      out_.features.push_back(std::move(feature));
      out_.measures.push_back(m);
    }
  }

  const Solid& solid_;
  const TriangleMesh& mesh_;
  const Facets& facets_;
  RegionGrower& grower_;
  std::vector<Region> regions_;
  std::vector<RegionMeasure> measures_;
  std::vector<double> chord_mm_;
  std::vector<std::int32_t> owner_;
  double largest_chord_mm_ = 0.0;
  Recognition out_;
};

}  // namespace

Recognition finish_recognition(const Solid& solid, const Facets& facets, RegionGrower& grower,
                               std::vector<Region> regions, bool planes) {
  return Finisher(solid, facets, grower, std::move(regions)).run(planes);
}

}  // namespace mortise
