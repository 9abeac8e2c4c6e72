#include "common/geometry/recognition/surface_guess.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace mortise {
namespace {

// Facets of a cylinder or cone stand at one angle to the axis; a spread above this is another kind.
constexpr double kInclinationSpread = 0.1;

// Points spread less than this across a line or plane, as a share squared, lie in it.
constexpr double kSingular = 1e-14;

Vec3 middle_of(std::span<const Vec3> points) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : points) middle += x;
  return middle / static_cast<double>(points.size());
}

// Adds v v^T, the lower half alone.
void add_square(Mat3& sum, const Vec3& v) {
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) sum(i, j) += v[i] * v[j];
}

// A symmetric matrix of its lower half.
Mat3 whole(const Mat3& lower) { return lower.selfadjointView<Eigen::Lower>(); }

// Circle through points of a plane, algebraic least squares (Kasa): x^2 + y^2 = 2ax + 2by + c.
struct Circle {
  double x = 0.0, y = 0.0, radius = 0.0;
};
std::optional<Circle> circle_through(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& p : points) middle += p;
  middle /= static_cast<double>(points.size());
  double extent2 = 0.0;
  for (const auto& p : points) extent2 = std::max(extent2, (p - middle).squaredNorm());
  if (!(extent2 > 0.0)) return std::nullopt;
  const double extent = std::sqrt(extent2);
  // About the middle the constant does not depend on the place of the centre.
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d skew = Eigen::Vector2d::Zero();
  double mean = 0.0;
  for (const auto& p : points) {
    const Eigen::Vector2d q = (p - middle) / extent;
    spread += q * q.transpose();
    skew += 0.5 * q.squaredNorm() * q;
    mean += q.squaredNorm() / static_cast<double>(points.size());
  }
  const double det = spread.determinant();
  if (!(det > kSingular * spread(0, 0) * spread(1, 1))) return std::nullopt;
  const Eigen::Vector2d s = spread.inverse() * skew;
  const double radius2 = mean + s.squaredNorm();
  if (!(radius2 > 0.0)) return std::nullopt;
  return Circle{middle.x() + extent * s.x(), middle.y() + extent * s.y(),
                extent * std::sqrt(radius2)};
}

bool inclined_alike(std::span<const OrientedPoint> facets, const Vec3& axis, double mean) {
  for (const OrientedPoint& f : facets)
    if (std::fabs(f.normal.dot(axis) - mean) > kInclinationSpread) return false;
  return true;
}

}  // namespace

std::optional<Vec3> steady_direction(std::span<const OrientedPoint> facets, const Vec3& about) {
  Mat3 spread = Mat3::Zero();
  for (const OrientedPoint& f : facets) add_square(spread, f.normal - about);
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  // All normals on one line within 1e-6 rad, which is what rounded corners leave: any axis would
  // do.
  if (!(solver.eigenvalues()[1] > 1e-12 * static_cast<double>(facets.size()))) return std::nullopt;
  return Vec3(solver.eigenvectors().col(0));
}

std::optional<Surface> guess_cylinder(std::span<const Vec3> points,
                                      std::span<const OrientedPoint> facets) {
  if (facets.size() < 2 || points.size() < 6) return std::nullopt;
  const auto axis = steady_direction(facets, Vec3::Zero());
  if (!axis || !inclined_alike(facets, *axis, 0.0)) return std::nullopt;
  const Vec3 u = axis->unitOrthogonal(), v = axis->cross(u), middle = middle_of(points);
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(points.size());
  for (const Vec3& x : points) flat.emplace_back((x - middle).dot(u), (x - middle).dot(v));
  const auto circle = circle_through(flat);
  if (!circle) return std::nullopt;
  Surface s;
  s.kind = SurfaceKind::kCylinder;
  s.axis = *axis;
  s.point = middle + circle->x * u + circle->y * v;
  s.radius_mm = circle->radius;
  return s;
}

std::optional<Surface> guess_cone(std::span<const Vec3> points,
                                  std::span<const OrientedPoint> facets) {
  if (facets.size() < 3 || points.size() < 6) return std::nullopt;
  Vec3 about = Vec3::Zero();
  for (const OrientedPoint& f : facets) about += f.normal;
  about /= static_cast<double>(facets.size());
  const auto axis = steady_direction(facets, about);
  if (!axis) return std::nullopt;
  const double sine = about.dot(*axis);
  // Flatter than 0.8 degrees from a plane: the apex is where rounding puts it.
  if (!inclined_alike(facets, *axis, sine) || std::fabs(sine) > 0.9999) return std::nullopt;
  // The apex lies in all facet planes.
  Mat3 a = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  const Vec3 middle = middle_of(points);
  for (const OrientedPoint& f : facets) {
    add_square(a, f.normal);
    b += f.normal * f.normal.dot(f.point - middle);
  }
  const Vec3 apex = a.ldlt().solve(b);
  if (!apex.allFinite()) return std::nullopt;
  Surface s;
  s.kind = SurfaceKind::kCone;
  s.point = middle + apex;
  s.axis = apex.dot(*axis) > 0.0 ? Vec3(-*axis) : *axis;
  s.half_angle_rad = std::asin(std::fabs(sine));
  return s;
}

std::optional<Surface> guess_sphere(std::span<const Vec3> points) {
  if (points.size() < 5) return std::nullopt;
  const Vec3 middle = middle_of(points);
  double extent2 = 0.0;
  for (const Vec3& x : points) extent2 = std::max(extent2, (x - middle).squaredNorm());
  if (!(extent2 > 0.0)) return std::nullopt;
  const double extent = std::sqrt(extent2);
  // About the middle the constant does not depend on the place of the centre.
  Mat3 spread = Mat3::Zero();
  Vec3 skew = Vec3::Zero();
  double mean = 0.0;
  for (const Vec3& x : points) {
    const Vec3 q = (x - middle) / extent;
    add_square(spread, q);
    skew += 0.5 * q.squaredNorm() * q;
    mean += q.squaredNorm() / static_cast<double>(points.size());
  }
  spread = whole(spread);
  const double det = spread.determinant();
  if (!(det > kSingular * spread(0, 0) * spread(1, 1) * spread(2, 2))) return std::nullopt;
  const Vec3 s = spread.inverse() * skew;
  const double radius2 = mean + s.squaredNorm();
  if (!(radius2 > 0.0)) return std::nullopt;
  Surface sphere;
  sphere.kind = SurfaceKind::kSphere;
  sphere.point = middle + extent * s;
  sphere.radius_mm = extent * std::sqrt(radius2);
  return sphere;
}

std::optional<Surface> guess_torus(std::span<const Vec3> points,
                                   std::span<const OrientedPoint> facets) {
  if (facets.size() < 6 || points.size() < 8) return std::nullopt;
  const Vec3 middle = middle_of(points);
  double extent2 = 0.0;
  for (const Vec3& x : points) extent2 = std::max(extent2, (x - middle).squaredNorm());
  if (!(extent2 > 0.0)) return std::nullopt;
  const double extent = std::sqrt(extent2);
  // Velocity field of a turn w about an axis with shift s: normal . (s + w x p) = 0 on all normals.
  Mat3 ss = Mat3::Zero(), sw = Mat3::Zero(), ww = Mat3::Zero();
  for (const OrientedPoint& f : facets) {
    const Vec3 moment = ((f.point - middle) / extent).cross(f.normal);
    add_square(ss, f.normal);
    sw.noalias() += f.normal * moment.transpose();
    add_square(ww, moment);
  }
  const Eigen::FullPivLU<Mat3> lu(whole(ss));
  if (!lu.isInvertible()) return std::nullopt;
  const Mat3 shift_of_turn = -lu.solve(sw);
  const Mat3 least = whole(ww) + sw.transpose() * shift_of_turn;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(0.5 * (least + least.transpose()));
  const Vec3 axis = solver.eigenvectors().col(0);
  const Vec3 on_axis = middle + extent * axis.cross(Vec3(shift_of_turn * axis));
  Surface about;
  about.point = on_axis;
  about.axis = axis;
  return guess_torus_about(about, points);
}

std::optional<Surface> guess_torus_about(const Surface& strip, std::span<const Vec3> points) {
  if (points.size() < 8) return std::nullopt;
  const Vec3 middle = middle_of(points);
  const Vec3 on_axis = strip.point + (middle - strip.point).dot(strip.axis) * strip.axis;
  std::vector<Eigen::Vector2d> meridian;
  meridian.reserve(points.size());
  for (const Vec3& x : points) {
    const double z = (x - on_axis).dot(strip.axis);
    meridian.emplace_back((x - on_axis - z * strip.axis).norm(), z);
  }
  const auto circle = circle_through(meridian);
  if (!circle || !(circle->x > circle->radius)) return std::nullopt;
  Surface s;
  s.kind = SurfaceKind::kTorus;
  s.axis = strip.axis;
  s.point = on_axis + circle->y * strip.axis;
  s.radius_mm = circle->x;
  s.tube_radius_mm = circle->radius;
  return s;
}

}  // namespace mortise
