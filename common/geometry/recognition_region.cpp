#include "common/geometry/recognition_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/constants.h"

namespace mortise {
namespace {

// A facet looks where its surface looks, within this angle (25 degrees): facets of one triangle
// have their middle off the middle of the step, and steep short ones are tilted.
constexpr double kLooksAlong = 0.906;
// A facet spans no more of the surface than this (50 degrees: the diagonal of a quad of 30 by 30).
constexpr double kSpanCosine = 0.643;
// A facet this many times as deep as the middle one is three times as wide: a flat cut.
constexpr double kDeepFacet = 9.0;
// The residual is less than this share of the height of the whole arc, else the surface is not told
// from its neighbours in shape.
constexpr double kShareOfArcHeight = 2e-3;
// Corners that a region needs: those that fix its surface, and as many more to bear it out.
constexpr std::size_t kCornersOfCylinder = 8, kCornersOfCone = 10, kCornersOfSphere = 9,
                      kCornersOfTorus = 15;
// Corners nearer than this along the arc are one step. rad
constexpr double kSameStep_rad = 1e-3;
// With four circles of corners a torus is told from unlike chamfers only by equal steps.
constexpr double kEqualSteps = 0.02;
constexpr std::size_t kLeastMeridianCircles = 5;
// While a region grows, so many of its corners are enough for a fit.
constexpr std::size_t kCornersOnTheWay = 1000;
// A part of the mesh radius by which corners are off for rounding of doubles.
constexpr double kRoundingShare = 1e-12;

double distance_from_axis(const Surface& s, const Vec3& x) {
  const Vec3 d = x - s.point;
  return (d - d.dot(s.axis) * s.axis).norm();
}

std::vector<double> distinct(std::vector<double> values, double apart) {
  std::sort(values.begin(), values.end());
  std::vector<double> kept;
  for (const double v : values)
    if (kept.empty() || v - kept.back() > apart) kept.push_back(v);
  return kept;
}

// Union of arcs, each less than half a turn; what is left open is the largest gap.
double covered_rad(std::vector<std::pair<double, double>> arcs) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (arcs.empty()) return 0.0;
  std::sort(arcs.begin(), arcs.end());
  double reach = arcs.front().first, gap = 0.0;
  for (const auto& [from, to] : arcs) {
    gap = std::max(gap, from - reach);
    reach = std::max(reach, to);
  }
  gap = std::max(gap, arcs.front().first + kTurn - reach);
  return gap <= kSameStep_rad ? kTurn : kTurn - gap;
}

// How far a facet stands off at its middles, where it is deepest or nearly so.
double depth_at_middles(const TriangleMesh& mesh, const Surface& surface, std::uint32_t t) {
  const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  double most = 0.0;
  for (const Vec3& x :
       {Vec3((a + b + c) / 3.0), Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))})
    most = std::max(most, std::fabs(surface.signed_distance_mm(x)));
  return most;
}

// The same on a grid of points of the triangle.
double depth_at_grid(const TriangleMesh& mesh, const Surface& surface, std::uint32_t t) {
  constexpr int kSteps = 6;
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3 x =
          (mesh.corner(t, 0) * i + mesh.corner(t, 1) * j + mesh.corner(t, 2) * (kSteps - i - j)) /
          kSteps;
      most = std::max(most, std::fabs(surface.signed_distance_mm(x)));
    }
  return most;
}

double arc_height(double radius, double arc_rad) {
  return radius * (1.0 - std::cos(0.5 * std::min(arc_rad, std::numbers::pi)));
}

struct AxisAngles {
  std::vector<double> corners, meridian, heights;
  std::vector<std::pair<double, double>> arcs;
};

AxisAngles angles_of(const TriangleMesh& mesh, const Surface& s,
                     std::span<const std::uint32_t> triangles) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  AxisAngles out;
  const Vec3 u = s.axis.unitOrthogonal(), v = s.axis.cross(u);
  for (const std::uint32_t t : triangles) {
    double first = 0.0, lo = 0.0, hi = 0.0;
    bool any = false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = mesh.corner(t, k) - s.point;
      const double x = d.dot(u), y = d.dot(v), z = d.dot(s.axis), rho = std::hypot(x, y);
      out.heights.push_back(z);
      if (s.kind == SurfaceKind::kTorus) out.meridian.push_back(std::atan2(z, rho - s.radius_mm));
      if (rho <= 1e-9 * (std::fabs(z) + s.radius_mm)) continue;  // an apex has no angle
      const double angle = std::atan2(y, x);
      out.corners.push_back(angle);
      if (!any) first = angle;
      any = true;
      const double turn = std::remainder(angle - first, kTurn);
      lo = std::min(lo, turn);
      hi = std::max(hi, turn);
    }
    if (!any) continue;
    out.arcs.emplace_back(first + lo, first + hi);
    if (first + lo < -std::numbers::pi)  // the same arc once more where the count begins
      out.arcs.emplace_back(first + lo + kTurn, first + hi + kTurn);
    if (first + hi > std::numbers::pi)
      out.arcs.emplace_back(first + lo - kTurn, first + hi - kTurn);
  }
  return out;
}

}  // namespace

double size_mm(const Surface& surface, const TriangleMesh& mesh,
               std::span<const std::uint32_t> triangles) {
  if (surface.kind == SurfaceKind::kTorus) return surface.tube_radius_mm;
  if (surface.kind != SurfaceKind::kCone) return surface.radius_mm;
  double most = 0.0;
  for (const std::uint32_t t : triangles)
    for (int k = 0; k < 3; ++k)
      most = std::max(most, distance_from_axis(surface, mesh.corner(t, k)));
  return most;
}

RegionMeasure measure_region(const TriangleMesh& mesh, const Surface& surface,
                             std::span<const std::uint32_t> triangles) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  RegionMeasure m;
  AxisAngles angles = angles_of(mesh, surface, triangles);
  m.arc_rad = covered_rad(std::move(angles.arcs));
  std::vector<double> steps = distinct(std::move(angles.corners), kSameStep_rad);
  // The first and the last can be one, on either side of half a turn.
  if (steps.size() > 1 && steps.front() + kTurn - steps.back() < kSameStep_rad) steps.pop_back();
  const bool closed = m.arc_rad >= kTurn;
  m.steps = static_cast<std::uint32_t>(steps.size()) - (closed || steps.empty() ? 0U : 1U);
  m.meridian_rad = distinct(std::move(angles.meridian), kSameStep_rad);
  const auto [lo, hi] = std::minmax_element(angles.heights.begin(), angles.heights.end());
  if (lo != angles.heights.end()) m.along_mm = {*lo, *hi};
  const double near = 1e-3 * m.along_mm.width();
  m.one_row = std::all_of(angles.heights.begin(), angles.heights.end(), [&](double z) {
    return z - m.along_mm.lo <= near || m.along_mm.hi - z <= near;
  });
  return m;
}

double chord_error_mm(const TriangleMesh& mesh, const Surface& surface,
                      std::span<const std::uint32_t> triangles) {
  double deepest = 0.0;
  for (const std::uint32_t t : triangles) {
    const double middles = depth_at_middles(mesh, surface, t);
    // Only where a triangle bends both ways does another point lie deeper, and not by much.
    if (middles < 0.5 * deepest) continue;
    deepest = std::max({deepest, middles, depth_at_grid(mesh, surface, t)});
  }
  return deepest;
}

RegionGrower::RegionGrower(const Solid& solid, const Facets& facets, double quantum_mm)
    : mesh_(solid.mesh()),
      topology_(solid.topology()),
      facets_(facets),
      rounding_mm_(2.0 * quantum_mm + kRoundingShare * solid.sphere().radius_mm),
      triangle_mark_(mesh_.triangles.size(), 0),
      point_mark_(mesh_.points_mm.size(), 0) {}

std::vector<Vec3> RegionGrower::points_of(std::span<const std::uint32_t> triangles) {
  ++mark_;
  std::vector<Vec3> points;
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t i : mesh_.triangles[t])
      if (point_mark_[i] != mark_) {
        point_mark_[i] = mark_;
        points.push_back(mesh_.points_mm[i]);
      }
  return points;
}

std::vector<OrientedPoint> RegionGrower::normals_of(
    std::span<const std::uint32_t> triangles) const {
  std::vector<OrientedPoint> normals;
  for (const std::uint32_t t : triangles) {
    const std::uint32_t f = facets_.of_triangle[t];
    if (!facets_.reliable[f]) continue;
    normals.push_back(
        {(mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3.0, facets_.normal[f]});
  }
  return normals;
}

bool RegionGrower::smooth(std::uint32_t facet_a, std::uint32_t facet_b) const {
  return facets_.angle_rad(facet_a, facet_b) <= kSmoothEdge_rad;
}

bool RegionGrower::belongs(std::uint32_t t, const Surface& surface, double allowed_mm) const {
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(surface.signed_distance_mm(mesh_.corner(t, k))) <= allowed_mm)) return false;
  const std::uint32_t f = facets_.of_triangle[t];
  if (!facets_.reliable[f]) return true;
  const Vec3 middle = (mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3.0;
  if (facets_.normal[f].dot(surface.outward_normal(middle)) < kLooksAlong) return false;
  std::array<Vec3, 3> outward;
  for (int k = 0; k < 3; ++k) {
    const Vec3& x = mesh_.corner(t, k);
    const bool apex = surface.kind == SurfaceKind::kCone &&
                      distance_from_axis(surface, x) <= 1e-6 * (x - middle).norm();
    outward[k] = surface.outward_normal(apex ? middle : x);
  }
  return outward[0].dot(outward[1]) > kSpanCosine && outward[1].dot(outward[2]) > kSpanCosine &&
         outward[2].dot(outward[0]) > kSpanCosine;
}

void RegionGrower::spread(const Surface& surface, double allowed_mm, std::size_t limit,
                          std::vector<std::uint32_t>& triangles) {
  ++mark_;
  for (const std::uint32_t t : triangles) triangle_mark_[t] = mark_;
  for (std::size_t next = 0; next < triangles.size() && triangles.size() < limit; ++next) {
    const std::uint32_t t = triangles[next];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = topology_.neighbor[t][k];
      if (other == Topology::kNone || triangle_mark_[other] == mark_ ||
          topology_.edge_kind[t][k] == EdgeKind::kNonManifold ||
          !smooth(facets_.of_triangle[t], facets_.of_triangle[other]))
        continue;
      if (!belongs(other, surface, allowed_mm)) continue;
      triangle_mark_[other] = mark_;
      triangles.push_back(other);
    }
  }
}

bool RegionGrower::refit(Region& region, std::size_t most) {
  const std::vector<Vec3> points = points_of(region.triangles);
  const std::size_t stride = 1 + points.size() / most;
  std::vector<Vec3> some;
  if (stride > 1)
    for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  const auto fitted = fitted_surface(region.surface, stride > 1 ? some : points);
  if (!fitted) return false;
  region.surface = *fitted;
  region.residual_mm = residual_of(region.surface, points);
  region.allowed_mm =
      region.share * size_mm(region.surface, mesh_, region.triangles) + rounding_mm_;
  return true;
}

void RegionGrower::drop_deep_facets(Region& region) const {
  std::vector<double> depth;
  for (const std::uint32_t t : region.triangles)
    depth.push_back(depth_at_middles(mesh_, region.surface, t));
  std::vector<double> sorted = depth;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double most = kDeepFacet * sorted[sorted.size() / 2] + region.allowed_mm;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (depth[i] <= most) kept.push_back(region.triangles[i]);
  region.triangles = std::move(kept);
}

bool RegionGrower::shows_enough(const Region& region) {
  const Surface& s = region.surface;
  const std::size_t corners = points_of(region.triangles).size();
  if (s.kind == SurfaceKind::kSphere)
    return corners >= kCornersOfSphere && shows_enough_of_sphere(region);
  const RegionMeasure m = measure_region(mesh_, s, region.triangles);
  if (s.kind == SurfaceKind::kTorus)
    return corners >= kCornersOfTorus && shows_enough_of_torus(region, m);
  if (corners < (s.kind == SurfaceKind::kCone ? kCornersOfCone : kCornersOfCylinder) || m.steps < 3)
    return false;
  const double radius = size_mm(s, mesh_, region.triangles);
  return region.residual_mm <= kShareOfArcHeight * arc_height(radius, m.arc_rad);
}

// The widest angle about the centre stands for the arc. All corners on two circles: a cone as well.
bool RegionGrower::shows_enough_of_sphere(const Region& region) const {
  const Surface& s = region.surface;
  const std::vector<OrientedPoint> normals = normals_of(region.triangles);
  Vec3 mean = Vec3::Zero();
  for (const OrientedPoint& f : normals) mean += f.normal;
  if (normals.empty()) return false;
  mean /= static_cast<double>(normals.size());
  double least = 1.0;
  if (mean.norm() > 1e-9)
    for (const OrientedPoint& f : normals) least = std::min(least, f.normal.dot(mean.normalized()));
  else
    least = -1.0;
  if (region.residual_mm > kShareOfArcHeight * s.radius_mm * (1.0 - least)) return false;
  const auto axis = steady_direction(normals, mean);
  if (!axis) return false;
  Surface about = s;
  about.axis = *axis;
  return !measure_region(mesh_, about, region.triangles).one_row;
}

bool RegionGrower::shows_enough_of_torus(const Region& region, const RegionMeasure& m) const {
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

bool RegionGrower::settle(Region& region) {
  return refit(region) && region.residual_mm <= region.allowed_mm && shows_enough(region);
}

std::optional<Region> RegionGrower::grow(const Surface& guess, std::span<const std::uint32_t> seeds,
                                         double share) {
  Region region;
  region.surface = guess;
  region.share = share;
  region.triangles.assign(seeds.begin(), seeds.end());
  region.allowed_mm = share * size_mm(guess, mesh_, seeds) + rounding_mm_;
  region.residual_mm = residual_of(guess, points_of(seeds));
  if (region.residual_mm > region.allowed_mm) return std::nullopt;
  // 1. which side is the material on? The facets say.
  double outward = 0.0;
  for (const OrientedPoint& f : normals_of(seeds))
    outward += f.normal.dot(region.surface.outward_normal(f.point)) > 0.0 ? 1.0 : -1.0;
  if (outward < 0.0) region.surface.inward = !region.surface.inward;
  for (const std::uint32_t t : seeds)
    if (!belongs(t, region.surface, region.allowed_mm)) return std::nullopt;
  // 2. outward in doubling steps, a fit after each
  for (std::size_t limit = 2 * seeds.size();; limit *= 2) {
    const std::size_t before = region.triangles.size();
    spread(region.surface, region.allowed_mm, limit, region.triangles);
    if (region.triangles.size() == before) break;
    if (!refit(region, kCornersOnTheWay)) return std::nullopt;
  }
  // 3. what does not belong to the settled surface goes, until it is settled
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    drop_deep_facets(region);
    std::erase_if(region.triangles,
                  [&](std::uint32_t t) { return !belongs(t, region.surface, region.allowed_mm); });
    if (region.triangles.size() < seeds.size()) return std::nullopt;
    if (!refit(region)) return std::nullopt;
    if (region.residual_mm <= region.allowed_mm) break;
  }
  if (region.residual_mm > region.allowed_mm || !shows_enough(region)) return std::nullopt;
  std::sort(region.triangles.begin(), region.triangles.end());
  return region;
}

}  // namespace mortise
