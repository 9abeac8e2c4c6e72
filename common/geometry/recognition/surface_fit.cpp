#include "common/geometry/recognition/surface_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

constexpr int kMaxParameters = 7;  // of a torus: point, axis, two radii
using Vec7 = Eigen::Matrix<double, kMaxParameters, 1>;
using Mat7 = Eigen::Matrix<double, kMaxParameters, kMaxParameters>;

// From a fair guess a few are enough, as each wins decades; what still goes on then has no minimum.
constexpr int kIterations = 25;
// Iterations after which a fit must be near: it wins decades a step.
constexpr int kPatience = 3;
// A root mean square residual that only rounding leaves, as a share of the extent.
constexpr double kExact = 1e-15;
// A radius this many times the extent of the points says that they are flat.
constexpr double kFlatRadius = 1e4;
// Below this half angle a cone is a cylinder, and above its complement a plane. rad
constexpr double kLeastHalfAngle_rad = 1e-4;

// The surface about a frame near the points, in units of their extent: a cone has no apex here,
// which may be far away. Parameters: shifts along u, v (sphere, torus: a too), tilts of the axis to
// u and v, then sizes.
struct Model {
  SurfaceKind kind = SurfaceKind::kUnknown;
  Vec3 p = Vec3::Zero(), a = Vec3::UnitZ(), u = Vec3::UnitX(), v = Vec3::UnitY();
  double size = 0.0;   // cylinder, sphere: radius; cone: radius at p; torus: of the centre circle
  double other = 0.0;  // cone: half angle; torus: tube radius
  double cosine = 1.0, sine = 0.0;  // of `other`

  int parameters() const {
    switch (kind) {
      case SurfaceKind::kSphere:
        return 4;
      case SurfaceKind::kCylinder:
        return 5;
      case SurfaceKind::kCone:
        return 6;
      default:
        return 7;
    }
  }
  void set_angle(double angle) {
    other = angle;
    cosine = std::cos(angle);
    sine = std::sin(angle);
  }
  void set_axis(const Vec3& axis) {
    a = axis.normalized();
    u = a.unitOrthogonal();
    v = a.cross(u);
  }
};

struct Row {
  double residual = 0.0;
  Vec7 slope = Vec7::Zero();
};

double residual_at(const Model& m, const Vec3& x) {
  const Vec3 d = x - m.p;
  if (m.kind == SurfaceKind::kSphere) return d.norm() - m.size;
  const double z = d.dot(m.a), rho = (d - z * m.a).norm();
  if (m.kind == SurfaceKind::kCylinder) return rho - m.size;
  if (m.kind == SurfaceKind::kTorus) return std::hypot(rho - m.size, z) - m.other;
  return (rho - m.size) * m.cosine - z * m.sine;
}

Row row_of(const Model& m, const Vec3& x) {
  Row row;
  const Vec3 d = x - m.p;
  if (m.kind == SurfaceKind::kSphere) {
    const double length = d.norm();
    row.residual = length - m.size;
    if (length > 0.0) row.slope.head<3>() = -d / length;
    row.slope[3] = -1.0;
    return row;
  }
  const double z = d.dot(m.a);
  const Vec3 across = d - z * m.a;
  const double rho = across.norm();
  const Vec3 w = rho > 0.0 ? Vec3(across / rho) : m.u;
  const double wu = w.dot(m.u), wv = w.dot(m.v);
  double to_rho = 1.0, to_z = 0.0;  // derivatives of the residual
  if (m.kind == SurfaceKind::kCylinder) {
    row.residual = rho - m.size;
    row.slope[4] = -1.0;
  } else if (m.kind == SurfaceKind::kCone) {
    to_rho = m.cosine;
    to_z = -m.sine;
    row.residual = (rho - m.size) * to_rho + z * to_z;
    row.slope[4] = -to_rho;
    row.slope[5] = (rho - m.size) * to_z - z * to_rho;
  } else {
    const double q = rho - m.size, tube = std::hypot(q, z);
    to_rho = tube > 0.0 ? q / tube : 1.0;
    to_z = tube > 0.0 ? z / tube : 0.0;
    row.residual = tube - m.other;
    row.slope[4] = -to_z;  // shift along the axis
    row.slope[5] = -to_rho;
    row.slope[6] = -1.0;
  }
  row.slope[0] = -to_rho * wu;
  row.slope[1] = -to_rho * wv;
  row.slope[2] = (-to_rho * z + to_z * rho) * wu;
  row.slope[3] = (-to_rho * z + to_z * rho) * wv;
  return row;
}

Model moved(const Model& m, const Vec7& step) {
  Model next = m;
  if (m.kind == SurfaceKind::kSphere) {
    next.p += step.head<3>();
    next.size += step[3];
    return next;
  }
  next.p += step[0] * m.u + step[1] * m.v;
  next.set_axis(m.a + step[2] * m.u + step[3] * m.v);
  if (m.kind == SurfaceKind::kTorus) {
    next.p += step[4] * m.a;
    next.size += step[5];
    next.other += step[6];
  } else {
    next.size += step[4];
    if (m.kind == SurfaceKind::kCone) next.set_angle(m.other + step[5]);
  }
  return next;
}

double cost_of(const Model& m, std::span<const Vec3> points) {
  double cost = 0.0;
  for (const Vec3& x : points) {
    const double residual = residual_at(m, x);
    cost += residual * residual;
  }
  return cost;
}

// Points about the origin with unit extent.
struct Scaled {
  Vec3 middle = Vec3::Zero();
  double extent = 1.0;
  std::vector<Vec3> points;
};

Scaled scaled(std::span<const Vec3> points) {
  Scaled out;
  for (const Vec3& x : points) out.middle += x;
  out.middle /= static_cast<double>(points.size());
  double extent2 = 0.0;
  for (const Vec3& x : points) extent2 = std::max(extent2, (x - out.middle).squaredNorm());
  out.extent = std::sqrt(extent2);
  if (!(out.extent > 0.0)) return out;
  out.points.reserve(points.size());
  for (const Vec3& x : points) out.points.push_back((x - out.middle) / out.extent);
  return out;
}

Model model_of(const Surface& s, const Scaled& frame) {
  Model m;
  m.kind = s.kind;
  m.p = (s.point - frame.middle) / frame.extent;
  m.set_axis(s.axis);
  if (s.kind == SurfaceKind::kCylinder || s.kind == SurfaceKind::kCone) {
    const double along = -m.p.dot(m.a);  // the foot of the middle of the points
    m.p += along * m.a;
    m.set_angle(s.half_angle_rad);
    m.size = s.kind == SurfaceKind::kCone ? along * std::tan(s.half_angle_rad)
                                          : s.radius_mm / frame.extent;
  } else {
    m.size = s.radius_mm / frame.extent;
    m.other = s.tube_radius_mm / frame.extent;
  }
  return m;
}

bool sound(const Model& m) {
  if (!m.p.allFinite() || !m.a.allFinite() || !std::isfinite(m.size + m.other)) return false;
  if (m.kind == SurfaceKind::kCone)
    return std::fabs(m.other) > kLeastHalfAngle_rad &&
           std::fabs(m.other) < 1.57079632679489662 - kLeastHalfAngle_rad;
  if (!(m.size > 0.0) || m.size > kFlatRadius) return false;
  return m.kind != SurfaceKind::kTorus || (m.other > 0.0 && m.other < m.size);
}

Surface surface_of(const Model& m, const Scaled& frame, bool inward) {
  Surface s;
  s.kind = m.kind;
  s.inward = inward;
  s.axis = m.a;
  s.point = frame.middle + frame.extent * m.p;
  if (m.kind == SurfaceKind::kCone) {
    s.half_angle_rad = std::fabs(m.other);
    s.point -= frame.extent * m.size / std::tan(m.other) * m.a;
    if (m.other < 0.0) s.axis = -m.a;
    return s;
  }
  s.radius_mm = frame.extent * m.size;
  if (m.kind == SurfaceKind::kTorus) s.tube_radius_mm = frame.extent * m.other;
  return s;
}

}  // namespace

std::optional<Surface> fitted_surface(const Surface& start, std::span<const Vec3> points,
                                      double worth_going_on, double hopeless_mm) {
  if (points.size() < 4) return std::nullopt;
  const Scaled frame = scaled(points);
  if (!(frame.extent > 0.0)) return std::nullopt;
  Model m = model_of(start, frame);
  const int n = m.parameters();
  double cost = cost_of(m, frame.points), damping = 1e-6;
  const double exact = std::pow(kExact, 2) * static_cast<double>(frame.points.size());
  const double hopeless =
      std::pow(hopeless_mm / frame.extent, 2) * static_cast<double>(points.size());
  for (int i = 0; i < kIterations && cost > exact && std::isfinite(cost); ++i) {
    Mat7 normal = Mat7::Zero();
    Vec7 gradient = Vec7::Zero();
    for (const Vec3& x : frame.points) {
      const Row row = row_of(m, x);
      normal.noalias() += row.slope * row.slope.transpose();
      gradient += row.residual * row.slope;
    }
    if (i >= kPatience && cost > hopeless) return std::nullopt;
    bool better = false;
    double step_size = 0.0;
    const double cost_before = cost;
    for (int tries = 0; tries < 6 && !better; ++tries) {
      Mat7 damped = normal;
      for (int k = 0; k < kMaxParameters; ++k)
        damped(k, k) = k < n ? normal(k, k) * (1.0 + damping) + 1e-300 : 1.0;
      const Vec7 step = -Vec7(damped.ldlt().solve(gradient));
      if (!step.allFinite()) return std::nullopt;
      const Model next = moved(m, step);
      const double next_cost = cost_of(next, frame.points);
      step_size = step.norm();
      better = next_cost < cost;
      if (better) {
        m = next;
        cost = next_cost;
        damping = std::max(1e-14, 0.05 * damping);
      } else {
        damping = std::min(1e6, 20.0 * damping);
      }
    }
    if (!better || step_size < 1e-15 || cost > (1.0 - worth_going_on) * cost_before) break;
  }
  if (!sound(m)) return std::nullopt;
  return surface_of(m, frame, start.inward);
}

double residual_of(const Surface& surface, std::span<const Vec3> points) {
  double most = 0.0;
  for (const Vec3& x : points) most = std::max(most, std::fabs(surface.signed_distance_mm(x)));
  return most;
}

}  // namespace mortise
