#include "common/depth/gpd/layer_depth.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/check.h"

namespace mortise {
namespace {

// Planes around a corner are one where normals and offsets differ by less.
constexpr double kSamePlaneNormal = 1e-7, kSame_mm = 1e-12;
// A corner misses its planes by no more than this share of the largest offset.
constexpr double kMissShare = 1e-9;
// A triangle may turn by no more than this (cosine) while its corners move.
constexpr double kLeastTurn = 0.99;
// Directions in which the planes around a corner say nothing.
constexpr double kNoDirection = 1e-6;
// Facets of one face that stand for a round surface meet at no more than this (cosine).
constexpr double kSmooth = 0.7;

// A plane around a corner; of facets that stand for one round surface the mean.
struct Moved {
  Vec3 n;
  double by_mm;
  int round_face = -1;            // none: a plane face
  std::vector<Vec3> facets = {};  // of a round one
};

double offset_of(const SurfaceBand::Face& face, LayerBody which) {
  const Interval& t = face.tolerance_mm;
  const Interval d = face.surface ? face.deviation_mm + face.unsure_mm : face.deviation_mm;
  return (which.largest ? t.hi : t.lo) + (which.outer ? d.hi : d.lo);
}

// Where the surface is round it does not reach as far out, or in, as where two facets meet.
void join(Moved& plane, bool outer) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& n : plane.facets) mean += n;
  mean.normalize();
  double least = 1.0;
  for (const Vec3& n : plane.facets) least = std::min(least, n.dot(mean));
  plane.n = mean;
  plane.by_mm = outer ? std::max(plane.by_mm, plane.by_mm / least)
                      : std::min(plane.by_mm, plane.by_mm / least);
}

// The least shift with n · d = by for all planes; where they have none in common, one that is
// beyond them all (outer) or below them all. False: it would be far off.
bool meet(const std::vector<Moved>& planes, bool outer, Vec3& d) {
  Eigen::MatrixXd m(planes.size(), 3);
  Eigen::VectorXd h(planes.size());
  double most = 0.0;
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    m.row(static_cast<Eigen::Index>(i)) = planes[i].n.transpose();
    h[static_cast<Eigen::Index>(i)] = planes[i].by_mm;
    most = std::max(most, std::fabs(planes[i].by_mm));
    mean += planes[i].n;
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kNoDirection);
  d = solver.compute(m).solve(h);
  double lack = 0.0, least = 1.0;
  mean.normalize();
  for (const Moved& plane : planes) {
    const double miss = plane.by_mm - plane.n.dot(d);
    lack = std::max(lack, outer ? miss : -miss);
    least = std::min(least, plane.n.dot(mean));
  }
  if (lack <= kMissShare * most) return true;
  if (!(least > 0.3)) return false;  // the corner would go more than three times as far as planes
  d += (outer ? 1.0 : -1.0) * lack / least * mean;
  return true;
}

Vec3 normal_of(const TriangleMesh& mesh, std::uint32_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0))
      .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
      .stableNormalized();
}

void add_plane(const Moved& plane, std::vector<Moved>& around) {
  const auto same = std::find_if(around.begin(), around.end(), [&](const Moved& other) {
    if (other.round_face != plane.round_face) return false;
    return plane.round_face >= 0 ? other.n.dot(plane.n) > kSmooth
                                 : (other.n - plane.n).norm() < kSamePlaneNormal &&
                                       std::fabs(other.by_mm - plane.by_mm) < kSame_mm;
  });
  Moved& into = same != around.end() ? *same : around.emplace_back(plane);
  if (plane.round_face >= 0 &&
      std::none_of(into.facets.begin(), into.facets.end(),
                   [&](const Vec3& n) { return (n - plane.n).norm() < kSamePlaneNormal; }))
    into.facets.push_back(plane.n);
}

bool has_offsets(const SurfaceBand& band, LayerBody which) {
  return std::any_of(band.faces.begin(), band.faces.end(),
                     [&](const SurfaceBand::Face& face) { return offset_of(face, which) != 0.0; });
}

Interval depth_of(const SolidPtr& a, const SolidPtr& b, const GpdQuery& query,
                  CcdScratch& scratch) {
  const SurfaceBand nominal = nominal_band();
  GpdQuery moved = query;
  moved.overlap.a = a.get();
  moved.overlap.b = b.get();
  moved.overlap.band_a = moved.overlap.band_b = &nominal;
  moved.known = nullptr;
  const OverlapResult overlap = find_overlap(moved.overlap, scratch);
  moved.regions = overlap.regions;
  return generalized_depth(moved, scratch).gpd_mm;
}

}  // namespace

SolidPtr layer_body(const SolidPtr& part, const SurfaceBand& band, LayerBody which) {
  if (!has_offsets(band, which)) return part;
  TriangleMesh mesh = part->mesh();
  std::vector<std::vector<Moved>> around(mesh.points_mm.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SurfaceBand::Face& face = band.face_of(t);
    const bool round = face.deviation_mm.width() > 0.0;
    const Moved plane{normal_of(mesh, t), offset_of(face, which),
                      round ? static_cast<int>(&face - band.faces.data()) : -1};
    if (plane.n.isZero(0.0)) return nullptr;
    for (const std::uint32_t corner : mesh.triangles[t]) add_plane(plane, around[corner]);
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    Vec3 d;
    if (around[i].empty()) continue;
    for (Moved& plane : around[i])
      if (plane.round_face >= 0) join(plane, which.outer);
    if (!meet(around[i], which.outer, d)) return nullptr;
    mesh.points_mm[i] += d;
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (!(normal_of(mesh, t).dot(normal_of(part->mesh(), t)) > kLeastTurn)) return nullptr;
  return std::make_shared<const Solid>(std::move(mesh));
}

LayerDepths depths_of_layers(const SolidPtr& a, const SolidPtr& b, const GpdQuery& query,
                             CcdScratch& scratch) {
  // Inner and outer bodies of plane faces are the same.
  struct Known {
    SolidPtr a, b;
    Interval depth_mm;
  };
  std::vector<Known> known;
  const auto depth = [&](const SolidPtr& of_a, const SolidPtr& of_b) {
    for (const Known& k : known)
      if (k.a->hash() == of_a->hash() && k.b->hash() == of_b->hash()) return k.depth_mm;
    known.push_back({of_a, of_b, depth_of(of_a, of_b, query, scratch)});
    return known.back().depth_mm;
  };
  LayerDepths depths;
  for (const bool largest : {false, true}) {
    Interval& ends = (largest ? depths.largest_mm : depths.least_mm).emplace();
    for (const bool outer : {false, true}) {
      const SolidPtr of_a = layer_body(a, *query.overlap.band_a, {largest, outer}),
                     of_b = layer_body(b, *query.overlap.band_b, {largest, outer});
      if (!of_a || !of_b) return {};
      (outer ? ends.hi : ends.lo) = outer ? depth(of_a, of_b).hi : depth(of_a, of_b).lo;
    }
  }
  // What parts the largest bodies parts the least ones.
  Interval &least = *depths.least_mm, &most = *depths.largest_mm;
  least.hi = std::min(least.hi, most.hi);
  least.lo = std::min(least.lo, least.hi);
  most.lo = std::clamp(least.lo, most.lo, most.hi);
  MORTISE_CHECK(0.0 <= least.lo && least.ordered() && most.ordered() && least.lo <= most.lo &&
                    least.hi <= most.hi,
                "the depth of the least bodies is no more than that of the largest");
  return depths;
}

}  // namespace mortise
