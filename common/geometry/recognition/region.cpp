#include "common/geometry/recognition/region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/constants.h"
#include "common/geometry/recognition/surface_fit.h"

namespace mortise {
namespace {

// A facet looks where its surface looks, within this angle (25 degrees): facets of one triangle
// have their middle off the middle of the step, and steep short ones are tilted.
constexpr double kLooksAlong = 0.906;
// A facet spans no more of the surface than this (50 degrees: the diagonal of a quad of 30 by 30).
constexpr double kSpanCosine = 0.643;
// A chord of this share of the least radius, squared, spans 41 degrees.
constexpr double kNarrow = 0.5;
// Over an edge as sharp as this (50 degrees) a ball still goes on: that all corners beyond lie on
// it is no chance. The cap at the pole meets its neighbours more sharply than other rows meet.
constexpr double kBallEdge_rad = 0.8727;
// A facet this many times as deep as the middle one is three times as wide: a flat cut.
constexpr double kDeepFacet = 9.0;
// The residual is less than this share of the height of the whole arc, else the surface is not told
// from its neighbours in shape.
constexpr double kShareOfArcHeight = 2e-3;
// Corners that a region needs: those that fix its surface, and as many more to bear it out.
constexpr std::size_t corners_needed(SurfaceKind kind) {
  if (kind == SurfaceKind::kTorus) return 15;
  if (kind == SurfaceKind::kSphere) return 9;
  return kind == SurfaceKind::kCone ? 10 : 8;
}
// With fewer circles of corners than this a torus is told from unlike chamfers only by equal steps.
constexpr std::size_t kLeastMeridianCircles = 5;
constexpr double kEqualSteps = 0.02;
// While a region grows, so many of its corners are enough for a fit.
constexpr std::size_t kCornersOnTheWay = 1000, kAllCorners = 100'000;
// A guess this many times as far off as corners may be from all that an earlier one reached would
// reach the same: a fit on the way brings it there.
constexpr double kSameGrowth = 30.0;
// A ball whose corners may be off by less than this part of what a flat one allowed is another.
constexpr double kMuchNearer = 0.25;
// Corners kept of what a growth reached.
constexpr std::size_t kCornersKept = 24;
// A part of the mesh radius by which corners are off for rounding of doubles.
constexpr double kRoundingShare = 1e-12;

double arc_height(double radius, double arc_rad) {
  return radius * (1.0 - std::cos(0.5 * std::min(arc_rad, std::numbers::pi)));
}

void drop_deep_facets(const TriangleMesh& mesh, Region& region) {
  std::vector<double> depth;
  const SurfaceAt at(region.surface);
  for (const std::uint32_t t : region.triangles) depth.push_back(depth_at_middles_mm(mesh, at, t));
  std::vector<double> sorted = depth;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double most = kDeepFacet * sorted[sorted.size() / 2] + region.allowed_mm;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (depth[i] <= most) kept.push_back(region.triangles[i]);
  region.triangles = std::move(kept);
}

bool shows_enough_of_torus(const Region& region, const RegionMeasure& m) {
  const Surface& s = region.surface;
  const auto& around = m.meridian_rad;
  if (m.steps < 3 || around.size() < 4) return false;
  const double tube_arc = around.back() - around.front();
  if (region.residual_mm > kShareOfArcHeight * arc_height(s.tube_radius_mm, tube_arc) ||
      region.residual_mm > kShareOfArcHeight * arc_height(s.radius_mm, m.arc_rad))
    return false;
  if (around.size() >= kLeastMeridianCircles) return true;
  double least = around[1] - around[0], most = least;
  for (std::size_t i = 2; i < around.size(); ++i) {
    least = std::min(least, around[i] - around[i - 1]);
    most = std::max(most, around[i] - around[i - 1]);
  }
  return most <= (1.0 + kEqualSteps) * least;
}

// The widest angle about the centre stands for the arc; told by the places of the facets, since the
// normals of a nearly flat region turn by more than it spans.
bool bends_enough(const Region& ball, std::span<const OrientedPoint> facets) {
  const Surface& s = ball.surface;
  if (facets.empty()) return false;
  Vec3 mean_place = Vec3::Zero();
  for (const OrientedPoint& f : facets) mean_place += (f.point - s.point).normalized();
  double least = -1.0;
  // All around the ball places cancel, and no side is its middle.
  if (mean_place.norm() > 1e-9 * static_cast<double>(facets.size())) {
    least = 1.0;
    for (const OrientedPoint& f : facets)
      least = std::min(least, (f.point - s.point).normalized().dot(mean_place.normalized()));
  }
  return ball.residual_mm <= kShareOfArcHeight * s.radius_mm * (1.0 - least);
}

}  // namespace

std::vector<Vec3> corners_of(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                             Marks& met) {
  met.clear();
  std::vector<Vec3> points;
  points.reserve(triangles.size() + 2);
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t i : mesh.triangles[t])
      if (met.add(i)) points.push_back(mesh.points_mm[i]);
  return points;
}

void FlatBalls::keep(const Region& ball, std::size_t triangles_of_mesh) {
  of_triangle_.resize(triangles_of_mesh, 0);
  balls_.push_back({ball.share, ball.allowed_mm});
  for (const std::uint32_t t : ball.triangles)
    of_triangle_[t] = static_cast<std::uint32_t>(balls_.size());
}

bool FlatBalls::hold(std::span<const std::uint32_t> seeds, const Region& start) const {
  if (start.surface.kind != SurfaceKind::kSphere || balls_.empty()) return false;
  const std::uint32_t id = of_triangle_[seeds.front()];
  return id != 0 && balls_[id - 1].share == start.share &&
         start.allowed_mm >= kMuchNearer * balls_[id - 1].allowed_mm &&
         std::all_of(seeds.begin(), seeds.end(),
                     [&](std::uint32_t t) { return of_triangle_[t] == id; });
}

RegionGrower::RegionGrower(const Solid& solid, const Facets& facets, double quantum_mm, bool plain)
    : mesh_(solid.mesh()),
      topology_(solid.topology()),
      facets_(facets),
      rounding_mm_(2.0 * quantum_mm + kRoundingShare * solid.sphere().radius_mm),
      plain_(plain),
      corners_(mesh_.points_mm.size()),
      triangle_mark_(mesh_.triangles.size(), 0),
      point_asked_(mesh_.points_mm.size(), 0) {
  tell_edges();
}

std::vector<OrientedPoint> RegionGrower::normals_of(
    std::span<const std::uint32_t> triangles) const {
  std::vector<OrientedPoint> normals;
  normals.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    const std::uint32_t f = facets_.of_triangle[t];
    if (!facets_.reliable[f]) continue;
    normals.push_back(
        {(mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3.0, facets_.normal[f]});
  }
  return normals;
}

void RegionGrower::tell_edges() {
  edges_.assign(mesh_.triangles.size(), {});
  for (std::uint32_t t = 0; t < edges_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = topology_.neighbor[t][k];
      if (other == Topology::kNone || topology_.edge_kind[t][k] == EdgeKind::kNonManifold) continue;
      const double angle = facets_.angle_rad(facets_.of_triangle[t], facets_.of_triangle[other]);
      if (angle <= kSmoothEdge_rad) edges_[t][k] |= kSmooth;
      if (angle <= kBallEdge_rad) edges_[t][k] |= kSmoothOfBall;
    }
}

bool RegionGrower::corners_lie_on(std::uint32_t t, const SurfaceAt& at, double allowed_mm) const {
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(at.outside_mm(mesh_.corner(t, k))) <= allowed_mm)) return false;
  return true;
}

// The same within one spread: about six triangles ask each corner.
bool RegionGrower::corners_asked_once(std::uint32_t t, const SurfaceAt& at, double allowed_mm) {
  for (const std::uint32_t i : mesh_.triangles[t]) {
    std::uint32_t& asked = point_asked_[i];
    if (asked / 2 != mark_)
      asked = 2 * mark_ + (std::fabs(at.outside_mm(mesh_.points_mm[i])) <= allowed_mm ? 1U : 0U);
    if (asked % 2 == 0) return false;
  }
  return true;
}

bool RegionGrower::belongs(std::uint32_t t, const SurfaceAt& at, double allowed_mm) const {
  return corners_lie_on(t, at, allowed_mm) && looks_along(t, at, allowed_mm);
}

// Of a triangle whose corners lie on the surface: does it stand for that?
bool RegionGrower::looks_along(std::uint32_t t, const SurfaceAt& at, double allowed_mm) const {
  const Surface& surface = at.surface();
  const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
  if (const std::uint32_t f = facets_.of_triangle[t]; facets_.reliable[f]) {
    const Vec3 middle = (a + b + c) / 3.0;
    if (facets_.normal[f].dot(at.outward_normal(middle)) < kLooksAlong) return false;
    // Where edges are shorter than the radius, normals turn by less than 50 degrees along them.
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const double radius = least_radius_mm(surface, a, b, c) - allowed_mm;
    const bool narrow = radius > 0.0 && longest2 < kNarrow * radius * radius;
    std::array<Vec3, 3> outward;
    for (int k = 0; k < 3 && !narrow; ++k) {
      const Vec3& x = mesh_.corner(t, k);
      const bool apex = surface.kind == SurfaceKind::kCone &&
                        distance_from_axis_mm(surface, x) <= 1e-6 * (x - middle).norm();
      outward[k] = at.outside_normal(apex ? middle : x);
    }
    if (!narrow &&
        !(outward[0].dot(outward[1]) > kSpanCosine && outward[1].dot(outward[2]) > kSpanCosine &&
          outward[2].dot(outward[0]) > kSpanCosine))
      return false;
  }
  return !surface.is_cap(a, b, c, allowed_mm);
}

void RegionGrower::spread(const Surface& surface, double allowed_mm, std::size_t limit,
                          std::vector<std::uint32_t>& triangles) {
  ++mark_;
  for (const std::uint32_t t : triangles) triangle_mark_[t] = mark_;
  const SurfaceAt at(surface);
  const std::uint8_t way = surface.kind == SurfaceKind::kSphere ? kSmoothOfBall : kSmooth;
  for (std::size_t next = 0; next < triangles.size() && triangles.size() < limit; ++next) {
    const std::uint32_t t = triangles[next];
    for (std::size_t k = 0; k < 3; ++k) {
      if ((edges_[t][k] & way) == 0) continue;
      const std::uint32_t other = topology_.neighbor[t][k];
      if (triangle_mark_[other] == mark_) continue;
      triangle_mark_[other] = mark_;  // taken or refused: asked once
      const bool on = plain_ ? corners_lie_on(other, at, allowed_mm)
                             : corners_asked_once(other, at, allowed_mm);
      if (on && looks_along(other, at, allowed_mm)) triangles.push_back(other);
    }
  }
}

// To all corners of the region where there are no more than `most`, else to every so-manyth.
bool RegionGrower::refit(Region& region, const std::vector<Vec3>& corners, std::size_t most) const {
  const std::size_t stride = 1 + corners.size() / most;
  std::vector<Vec3> some;
  if (stride > 1)
    for (std::size_t i = 0; i < corners.size(); i += stride) some.push_back(corners[i]);
  const auto fitted = fitted_surface(region.surface, stride > 1 ? some : corners);
  if (!fitted) return false;
  region.surface = *fitted;
  region.allowed_mm = region.share * size_mm(region.surface, corners) + rounding_mm_;
  return true;
}

bool RegionGrower::fit_all(Region& region) {
  const std::vector<Vec3> corners = points_of(region.triangles);
  if (corners.size() < corners_needed(region.surface.kind) || !refit(region, corners, kAllCorners))
    return false;
  region.residual_mm = residual_of(region.surface, corners);
  return true;
}

bool RegionGrower::shows_enough(const Region& region) {
  const Surface& s = region.surface;
  // Corners on two circles lie on a cone as well, and those of a low pyramid on flats.
  if (s.kind == SurfaceKind::kSphere)
    return bends_enough(region, normals_of(region.triangles)) &&
           fix_one_quadric(points_of(region.triangles), region.residual_mm);
  const RegionMeasure m = measure_region(mesh_, s, region.triangles);
  if (s.kind == SurfaceKind::kTorus) return shows_enough_of_torus(region, m);
  if (m.steps < 3) return false;
  const double radius = size_mm(s, mesh_, region.triangles);
  return region.residual_mm <= kShareOfArcHeight * arc_height(radius, m.arc_rad);
}

bool RegionGrower::settle(Region& region) {
  return fit_all(region) && region.residual_mm <= region.allowed_mm && shows_enough(region);
}

// Can the surface begin here? Says on which side its material is.
bool RegionGrower::starts(Region& region, const Seeds& seeds) const {
  region.residual_mm = residual_of(region.surface, seeds.corners);
  if (region.residual_mm > region.allowed_mm) return false;
  double outward = 0.0;
  const SurfaceAt at(region.surface);
  for (const OrientedPoint& f : seeds.normals)
    outward += f.normal.dot(at.outward_normal(f.point)) > 0.0 ? 1.0 : -1.0;
  if (outward < 0.0) region.surface.inward = !region.surface.inward;
  return std::all_of(seeds.triangles.begin(), seeds.triangles.end(),
                     [&](std::uint32_t t) { return belongs(t, at, region.allowed_mm); });
}

// What does not belong to the settled surface goes, until it is settled.
bool RegionGrower::settles(Region& region, std::size_t least) {
  if (points_of(region.triangles).size() < corners_needed(region.surface.kind)) return false;
  constexpr int kRounds = 4;  // what goes on losing facets is no surface
  for (int round = 0; round < kRounds; ++round) {
    drop_deep_facets(mesh_, region);
    const SurfaceAt at(region.surface);
    std::erase_if(region.triangles,
                  [&](std::uint32_t t) { return !belongs(t, at, region.allowed_mm); });
    if (region.triangles.size() < least || !fit_all(region)) return false;
    if (region.residual_mm <= region.allowed_mm) break;
  }
  if (region.residual_mm > region.allowed_mm) return false;
  if (!shows_enough(region)) {
    if (region.surface.kind == SurfaceKind::kSphere)
      flat_balls_.keep(region, mesh_.triangles.size());
    return false;
  }
  std::sort(region.triangles.begin(), region.triangles.end());
  return true;
}

// The attempt that reached all seeds, if the guess runs through all of what that reached: it would
// end as that did.
const RegionGrower::Attempt* RegionGrower::grown_before(const Surface& guess,
                                                        std::span<const std::uint32_t> seeds,
                                                        const Region& region) const {
  const auto& attempt_of = attempt_of_[static_cast<std::size_t>(guess.kind)];
  if (attempt_of.empty()) return nullptr;
  const std::uint32_t id = attempt_of[seeds.front()];
  if (id == 0 || !std::all_of(seeds.begin(), seeds.end(),
                              [&](std::uint32_t t) { return attempt_of[t] == id; }))
    return nullptr;
  const Attempt& attempt = attempts_[id - 1];
  if (attempt.share != region.share) return nullptr;
  const double near_mm = kSameGrowth * region.allowed_mm;
  const SurfaceAt at(guess);
  for (const Vec3& x : attempt.reached)
    if (!(std::fabs(at.signed_distance_mm(x)) <= near_mm)) return nullptr;
  return &attempt;
}

void RegionGrower::keep(SurfaceKind kind, double share, std::span<const std::uint32_t> reached,
                        const std::optional<Region>& outcome) {
  auto& attempt_of = attempt_of_[static_cast<std::size_t>(kind)];
  if (attempt_of.empty()) attempt_of.assign(mesh_.triangles.size(), 0);
  Attempt& attempt = attempts_.emplace_back();
  attempt.share = share;
  attempt.outcome = outcome;
  const std::size_t stride = 1 + reached.size() / kCornersKept;
  for (std::size_t i = 0; i < reached.size(); i += stride)
    attempt.reached.push_back(mesh_.corner(reached[i], static_cast<int>(i % 3)));
  for (const std::uint32_t t : reached)
    attempt_of[t] = static_cast<std::uint32_t>(attempts_.size());
}

std::optional<Region> RegionGrower::grow(const Surface& guess, const Seeds& seeds, double share) {
  Region region;
  region.surface = guess;
  region.share = share;
  region.triangles.assign(seeds.triangles.begin(), seeds.triangles.end());
  region.allowed_mm = share * size_mm(guess, seeds.corners) + rounding_mm_;
  if (flat_balls_.hold(seeds.triangles, region)) return std::nullopt;
  const Attempt* before = grown_before(guess, seeds.triangles, region);
  if (before && !before->outcome) return std::nullopt;
  if (!starts(region, seeds)) return std::nullopt;
  if (before) return before->outcome;
  // Outward in doubling steps, a fit after each.
  for (std::size_t limit = 2 * seeds.triangles.size();; limit *= 2) {
    const std::size_t size = region.triangles.size();
    spread(region.surface, region.allowed_mm, limit, region.triangles);
    if (region.triangles.size() == size) break;
    if (!refit(region, points_of(region.triangles), kCornersOnTheWay)) return std::nullopt;
  }
  const std::vector<std::uint32_t> reached = region.triangles;
  std::optional<Region> outcome;
  if (settles(region, seeds.triangles.size())) outcome = std::move(region);
  keep(guess.kind, share, reached, outcome);
  return outcome;
}

}  // namespace mortise
