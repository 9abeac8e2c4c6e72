#include "common/geometry/recognition/measure.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mortise {
namespace {

// Corners nearer than this along the arc are one step. rad
constexpr double kSameStep_rad = 1e-3;

// Corners whose terms of second degree, each about 1, sum up to less lie on another quadric as
// well: above what floats of a file leave (1e-6), below a cap of 5 degrees (1e-3).
constexpr double kOnAnother = 1e-4;

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

// The same as depth_at_middles_mm on a grid of points of the triangle.
double depth_at_grid(const TriangleMesh& mesh, const SurfaceAt& surface, std::uint32_t t) {
  constexpr int kSteps = 6;  // 28 points: a sagitta is met within 3 %
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

// Is a height about that of the one or the other end?
bool near_an_end(const Interval& along, double z) {
  const double near = 1e-3 * along.width();
  return z - along.lo <= near || along.hi - z <= near;
}

// Where a corner lies as seen from the axis.
struct CornerView {
  double z = 0.0, angle = 0.0, meridian = 0.0;
  bool at_axis = false;  // an apex has no angle
};

// Corners are shared by about six triangles, which follow each other closely: a view is kept until
// another corner of the same place is asked for.
class CornerViews {
 public:
  CornerViews(const TriangleMesh& mesh, const Surface& s)
      : mesh_(mesh), s_(s), u_(s.axis.unitOrthogonal()), v_(s.axis.cross(u_)) {
    corner_.fill(kNone);
  }

  // Calls fresh(view) for a corner that is not kept.
  template <class Fresh>
  const CornerView& of(std::uint32_t corner, Fresh&& fresh) {
    const std::size_t place = corner % kPlaces;
    CornerView& view = view_[place];
    if (corner_[place] == corner) return view;
    corner_[place] = corner;
    const Vec3 d = mesh_.points_mm[corner] - s_.point;
    const double x = d.dot(u_), y = d.dot(v_), rho = std::hypot(x, y);
    view.z = d.dot(s_.axis);
    if (s_.kind == SurfaceKind::kTorus) view.meridian = std::atan2(view.z, rho - s_.radius_mm);
    view.at_axis = rho <= 1e-9 * (std::fabs(view.z) + s_.radius_mm);
    view.angle = view.at_axis ? 0.0 : std::atan2(y, x);
    fresh(view);
    return view;
  }

 private:
  // What falls out is worked out again. Most regions have tens of corners: to clear 1024 places
  // took as long as to measure them.
  static constexpr std::size_t kPlaces = 128;
  static constexpr std::uint32_t kNone = 0xffffffffU;

  const TriangleMesh& mesh_;
  const Surface& s_;
  const Vec3 u_, v_;
  std::array<std::uint32_t, kPlaces> corner_;
  std::array<CornerView, kPlaces> view_;
};

// Each corner at least once.
struct AxisAngles {
  std::vector<double> corners, meridian, heights;
  std::vector<std::pair<double, double>> arcs;
};

AxisAngles angles_of(const TriangleMesh& mesh, const Surface& s,
                     std::span<const std::uint32_t> triangles) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  AxisAngles out;
  CornerViews views(mesh, s);
  const auto fresh = [&](const CornerView& view) {
    out.heights.push_back(view.z);
    if (s.kind == SurfaceKind::kTorus) out.meridian.push_back(view.meridian);
    if (!view.at_axis) out.corners.push_back(view.angle);
  };
  for (const std::uint32_t t : triangles) {
    double first = 0.0, lo = 0.0, hi = 0.0;
    bool any = false;
    for (const std::uint32_t corner : mesh.triangles[t]) {
      const CornerView& view = views.of(corner, fresh);
      if (view.at_axis) continue;
      if (!any) first = view.angle;
      any = true;
      double turn = view.angle - first;
      if (std::fabs(turn) > std::numbers::pi) turn = std::remainder(turn, kTurn);
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

double least_radius_mm(const Surface& s, const Vec3& a, const Vec3& b, const Vec3& c) {
  // A torus bends both ways at once.
  constexpr double kOfTube = 0.5;
  if (s.kind == SurfaceKind::kTorus)
    return kOfTube * std::min(s.tube_radius_mm, s.radius_mm - s.tube_radius_mm);
  if (s.kind != SurfaceKind::kCone) return s.radius_mm;
  return std::min(
      {distance_from_axis_mm(s, a), distance_from_axis_mm(s, b), distance_from_axis_mm(s, c)});
}

double distance_from_axis_mm(const Surface& s, const Vec3& x) {
  const Vec3 d = x - s.point;
  return (d - d.dot(s.axis) * s.axis).norm();
}

double depth_at_middles_mm(const TriangleMesh& mesh, const SurfaceAt& surface, std::uint32_t t) {
  const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  double most = 0.0;
  for (const Vec3& x :
       {Vec3((a + b + c) / 3.0), Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))})
    most = std::max(most, std::fabs(surface.signed_distance_mm(x)));
  return most;
}

double size_mm(const Surface& surface, const TriangleMesh& mesh,
               std::span<const std::uint32_t> triangles) {
  if (surface.kind == SurfaceKind::kTorus) return surface.tube_radius_mm;
  if (surface.kind != SurfaceKind::kCone) return surface.radius_mm;
  double most = 0.0;
  for (const std::uint32_t t : triangles)
    for (int k = 0; k < 3; ++k)
      most = std::max(most, distance_from_axis_mm(surface, mesh.corner(t, k)));
  return most;
}

double size_mm(const Surface& surface, std::span<const Vec3> corners) {
  if (surface.kind == SurfaceKind::kTorus) return surface.tube_radius_mm;
  if (surface.kind != SurfaceKind::kCone) return surface.radius_mm;
  double most = 0.0;
  for (const Vec3& x : corners) most = std::max(most, distance_from_axis_mm(surface, x));
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
  m.one_row = std::all_of(angles.heights.begin(), angles.heights.end(),
                          [&](double z) { return near_an_end(m.along_mm, z); });
  return m;
}

bool lie_in_one_row(const TriangleMesh& mesh, const Surface& surface,
                    std::span<const std::uint32_t> triangles) {
  const Interval along = extent_along_mm(mesh, surface, triangles);
  for (const std::uint32_t t : triangles)
    for (int k = 0; k < 3; ++k)
      if (!near_an_end(along, (mesh.corner(t, k) - surface.point).dot(surface.axis))) return false;
  return true;
}

bool fix_one_quadric(std::span<const Vec3> corners, double off_mm) {
  if (corners.empty()) return false;
  const double share = 1.0 / static_cast<double>(corners.size());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : corners) mean += share * x;
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : corners) spread += share * (x - mean) * (x - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> along(spread);
  // Each direction in its own unit: a flat cap is not told from two planes else.
  const Vec3 extent = along.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (extent[0] <= off_mm) return false;
  using Terms = Eigen::Matrix<double, 10, 1>;
  Eigen::Matrix<double, 10, 10> sum = Eigen::Matrix<double, 10, 10>::Zero();
  for (const Vec3& corner : corners) {
    const Vec3 x = (along.eigenvectors().transpose() * (corner - mean)).cwiseQuotient(extent);
    Terms terms;
    terms << 1.0, x, x.cwiseAbs2(), x[0] * x[1], x[0] * x[2], x[1] * x[2];
    sum += share * terms * terms.transpose();
  }
  // The least belongs to the surface itself, the second to the next that the corners are nearest
  // to.
  const double second = Eigen::SelfAdjointEigenSolver<decltype(sum)>(sum).eigenvalues()[1];
  return std::sqrt(std::max(second, 0.0)) > kOnAnother + off_mm / extent[0];
}

Interval extent_along_mm(const TriangleMesh& mesh, const Surface& surface,
                         std::span<const std::uint32_t> triangles) {
  if (triangles.empty()) return {};
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Interval along{kFar, -kFar};
  for (const std::uint32_t t : triangles)
    for (int k = 0; k < 3; ++k) {
      const double z = (mesh.corner(t, k) - surface.point).dot(surface.axis);
      along = {std::min(along.lo, z), std::max(along.hi, z)};
    }
  return along;
}

double chord_error_mm(const TriangleMesh& mesh, const Surface& surface,
                      std::span<const std::uint32_t> triangles) {
  double deepest = 0.0;
  const SurfaceAt at(surface);
  for (const std::uint32_t t : triangles) {
    const double middles = depth_at_middles_mm(mesh, at, t);
    // Only where a triangle bends both ways does another point lie deeper, and not by much.
    if (middles < 0.5 * deepest) continue;
    deepest = std::max({deepest, middles, depth_at_grid(mesh, at, t)});
  }
  return deepest;
}

}  // namespace mortise
