#include "common/geometry/recognition/surface_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/kernels/fit_sums.h"
#include "common/geometry/recognition/surface_guess.h"
#include "common/geometry/surface_at.h"

namespace mortise {
namespace {

// From a fair guess a few are enough, as each wins decades; what still goes on then has no minimum.
constexpr int kIterations = 25;
// Iterations after which a fit must be near: it wins decades a step.
constexpr int kPatience = 3;
// A root mean square residual that only rounding leaves, as a share of the extent.
constexpr double kExact = 1e-15;
// Damped by no more than this a step goes nearly all the way.
constexpr double kHardlyDamped = 1e-3;
// A radius this many times the extent of the points says that they are flat.
constexpr double kFlatRadius = 1e4;
// Below this half angle a cone is a cylinder, and above its complement a plane. rad
constexpr double kLeastHalfAngle_rad = 1e-4;

// Points that a kernel takes at a time.
constexpr std::size_t kLanes = 4;

// Point, axis, sizes.
constexpr int parameters_of(SurfaceKind kind) {
  if (kind == SurfaceKind::kSphere) return 4;
  if (kind == SurfaceKind::kCylinder) return 5;
  return kind == SurfaceKind::kCone ? 6 : 7;
}

template <SurfaceKind kind>
using Step = Eigen::Matrix<double, parameters_of(kind), 1>;

// The surface about a frame near the points, in units of their extent: a cone has no apex here,
// which may be far away. Parameters: shifts along u, v (sphere, torus: a too), tilts of the axis to
// u and v, then sizes.
struct Model {
  Vec3 p = Vec3::Zero(), a = Vec3::UnitZ(), u = Vec3::UnitX(), v = Vec3::UnitY();
  double size = 0.0;   // cylinder, sphere: radius; cone: radius at p; torus: of the centre circle
  double other = 0.0;  // cone: half angle; torus: tube radius
  double cosine = 1.0, sine = 0.0;  // of `other`

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

// Points about the origin with unit extent, in blocks of four x, four y, four z; places behind the
// last are zero.
struct Scaled {
  Vec3 middle = Vec3::Zero();
  double extent = 1.0;
  std::size_t count = 0;
  std::vector<double> blocks;
};

// What one pass over the points tells: the cost, and the normal equations of the next step.
template <SurfaceKind kind>
struct Sums {
  static constexpr int n = parameters_of(kind);
  double cost = 0.0;
  Eigen::Matrix<double, n, n> normal;  // lower half
  Step<kind> gradient;
};

template <SurfaceKind kind>
geometry::FitKernels::Sum kernel_of(const geometry::FitKernels& kernels) {
  if (kind == SurfaceKind::kCylinder) return kernels.cylinder;
  if (kind == SurfaceKind::kCone) return kernels.cone;
  return kind == SurfaceKind::kSphere ? kernels.sphere : kernels.torus;
}

// Stops where the cost so far is not below limit: it only grows.
template <SurfaceKind kind>
Sums<kind> sums_of(const Model& m, const Scaled& points, double limit) {
  constexpr int n = parameters_of(kind);
  const geometry::FitModel model{{m.p.x(), m.p.y(), m.p.z()},
                                 {m.a.x(), m.a.y(), m.a.z()},
                                 {m.u.x(), m.u.y(), m.u.z()},
                                 {m.v.x(), m.v.y(), m.v.z()},
                                 m.size,
                                 m.other,
                                 m.cosine,
                                 m.sine};
  geometry::FitPass pass;
  kernel_of<kind>(geometry::best_fit_sums())(model, points.blocks.data(), points.count, limit,
                                             pass);
  Sums<kind> sums;
  sums.cost = pass.cost;
  const double* entry = pass.normal;
  for (int i = 0; i < n; ++i) {
    sums.gradient[i] = pass.gradient[i];
    for (int j = 0; j <= i; ++j) sums.normal(i, j) = *entry++;
  }
  return sums;
}

// Solves A x = b by L D L^T, A symmetric, its lower half given; a direction without weight stays.
template <int n>
Eigen::Matrix<double, n, 1> solved(Eigen::Matrix<double, n, n> a, Eigen::Matrix<double, n, 1> x) {
  std::array<double, n> inverse;
  for (int j = 0; j < n; ++j) {
    double pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k) * a(k, k);
    a(j, j) = pivot;
    inverse[static_cast<std::size_t>(j)] = pivot != 0.0 ? 1.0 / pivot : 0.0;
    for (int i = j + 1; i < n; ++i) {
      double entry = a(i, j);
      for (int k = 0; k < j; ++k) entry -= a(i, k) * a(j, k) * a(k, k);
      a(i, j) = entry * inverse[static_cast<std::size_t>(j)];
    }
  }
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < i; ++k) x[i] -= a(i, k) * x[k];
  for (int i = 0; i < n; ++i) x[i] *= inverse[static_cast<std::size_t>(i)];
  for (int i = n - 1; i >= 0; --i)
    for (int k = i + 1; k < n; ++k) x[i] -= a(k, i) * x[k];
  return x;
}

template <SurfaceKind kind>
Model moved(const Model& m, const Step<kind>& step) {
  Model next = m;
  if constexpr (kind == SurfaceKind::kSphere) {
    next.p += step.template head<3>();
    next.size += step[3];
    return next;
  } else {
    next.p += step[0] * m.u + step[1] * m.v;
    next.set_axis(m.a + step[2] * m.u + step[3] * m.v);
    if constexpr (kind == SurfaceKind::kTorus) {
      next.p += step[4] * m.a;
      next.size += step[5];
      next.other += step[6];
    } else {
      next.size += step[4];
      if constexpr (kind == SurfaceKind::kCone) next.set_angle(m.other + step[5]);
    }
    return next;
  }
}

Scaled scaled(std::span<const Vec3> points) {
  Scaled out;
  for (const Vec3& x : points) out.middle += x;
  out.middle /= static_cast<double>(points.size());
  double extent2 = 0.0;
  for (const Vec3& x : points) extent2 = std::max(extent2, (x - out.middle).squaredNorm());
  out.extent = std::sqrt(extent2);
  if (!(out.extent > 0.0)) return out;
  out.count = points.size();
  out.blocks.assign((points.size() + kLanes - 1) / kLanes * 3 * kLanes, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 at = (points[i] - out.middle) / out.extent;
    double* block = &out.blocks[i / kLanes * 3 * kLanes + i % kLanes];
    for (int k = 0; k < 3; ++k) block[static_cast<std::size_t>(k) * kLanes] = at[k];
  }
  return out;
}

Model model_of(const Surface& s, const Scaled& frame) {
  Model m;
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

bool sound(SurfaceKind kind, const Model& m) {
  if (!m.p.allFinite() || !m.a.allFinite() || !std::isfinite(m.size + m.other)) return false;
  if (kind == SurfaceKind::kCone)
    return std::fabs(m.other) > kLeastHalfAngle_rad &&
           std::fabs(m.other) < 0.5 * std::numbers::pi - kLeastHalfAngle_rad;
  if (!(m.size > 0.0) || m.size > kFlatRadius) return false;
  return kind != SurfaceKind::kTorus || (m.other > 0.0 && m.other < m.size);
}

Surface surface_of(SurfaceKind kind, const Model& m, const Scaled& frame, bool inward) {
  Surface s;
  s.kind = kind;
  s.inward = inward;
  s.axis = m.a;
  s.point = frame.middle + frame.extent * m.p;
  if (kind == SurfaceKind::kCone) {
    s.half_angle_rad = std::fabs(m.other);
    s.point -= frame.extent * m.size / std::tan(m.other) * m.a;
    if (m.other < 0.0) s.axis = -m.a;
    return s;
  }
  s.radius_mm = frame.extent * m.size;
  if (kind == SurfaceKind::kTorus) s.tube_radius_mm = frame.extent * m.other;
  return s;
}

// Takes the largest step that lowers the cost, damping it as far as needed. Gives its length, or
// nothing when there is none.
template <SurfaceKind kind>
std::optional<double> take_step(const Scaled& frame, Model& m, Sums<kind>& sums, double& damping,
                                double worth_going_on) {
  // Each try damps more; what six do not lower is at its least, to rounding.
  constexpr int kTries = 6;
  for (int tries = 0; tries < kTries; ++tries) {
    auto damped = sums.normal;
    for (int k = 0; k < damped.rows(); ++k)
      damped(k, k) = sums.normal(k, k) * (1.0 + damping) + 1e-300;
    const Step<kind> step = -solved(damped, sums.gradient);
    if (!step.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    // What the least squares of the slopes promise to win.
    if (damping <= kHardlyDamped && -step.dot(sums.gradient) < worth_going_on * sums.cost)
      return std::nullopt;
    const Model next = moved<kind>(m, step);
    const Sums<kind> then = sums_of<kind>(next, frame, sums.cost);
    if (then.cost < sums.cost) {
      m = next;
      sums = then;
      damping = std::max(1e-14, 0.05 * damping);
      return step.norm();
    }
    damping = std::min(1e6, 20.0 * damping);
  }
  return std::nullopt;
}

template <SurfaceKind kind>
std::optional<Surface> fitted(const Surface& start, const Scaled& frame, double worth_going_on,
                              double hopeless_mm,
                              const std::optional<Surface>& nearer_start = std::nullopt) {
  Model m = model_of(start, frame);
  Sums<kind> sums = sums_of<kind>(m, frame, std::numeric_limits<double>::infinity());
  if (nearer_start) {
    const Model other = model_of(*nearer_start, frame);
    const Sums<kind> then = sums_of<kind>(other, frame, sums.cost);
    if (then.cost < sums.cost) {
      m = other;
      sums = then;
    }
  }
  double damping = 1e-6;
  const auto count = static_cast<double>(frame.count);
  const double exact = kExact * kExact * count;
  const double hopeless = std::pow(hopeless_mm / frame.extent, 2) * count;
  for (int i = 0; i < kIterations && sums.cost > exact && std::isfinite(sums.cost); ++i) {
    if (i >= kPatience && sums.cost > hopeless) return std::nullopt;
    const double cost_before = sums.cost;
    const auto step_size = take_step<kind>(frame, m, sums, damping, worth_going_on);
    if (step_size && std::isnan(*step_size)) return std::nullopt;
    // Steps are in units of the part: below this they are rounding.
    if (!step_size || *step_size < 1e-15 || sums.cost > (1.0 - worth_going_on) * cost_before) break;
  }
  if (!sound(kind, m)) return std::nullopt;
  return surface_of(kind, m, frame, start.inward);
}

}  // namespace

std::optional<Surface> fitted_surface(const Surface& start, std::span<const Vec3> points,
                                      double worth_going_on, double hopeless_mm) {
  if (points.size() < 4) return std::nullopt;
  const Scaled frame = scaled(points);
  if (!(frame.extent > 0.0)) return std::nullopt;
  switch (start.kind) {
    case SurfaceKind::kSphere:
      // The algebraic one is nearly there; on a flat region steps from afar win little each.
      return fitted<SurfaceKind::kSphere>(start, frame, worth_going_on, hopeless_mm,
                                          guess_sphere(points));
    case SurfaceKind::kCylinder:
      return fitted<SurfaceKind::kCylinder>(start, frame, worth_going_on, hopeless_mm);
    case SurfaceKind::kCone:
      return fitted<SurfaceKind::kCone>(start, frame, worth_going_on, hopeless_mm);
    case SurfaceKind::kTorus:
      return fitted<SurfaceKind::kTorus>(start, frame, worth_going_on, hopeless_mm);
    default:
      return std::nullopt;
  }
}

Residuals residuals_of(const Surface& surface, std::span<const Vec3> points) {
  Residuals all;
  double sum2 = 0.0;
  const SurfaceAt at(surface);
  for (const Vec3& x : points) {
    const double off = std::fabs(at.outside_mm(x));
    all.most_mm = std::max(all.most_mm, off);
    sum2 += off * off;
  }
  if (!points.empty()) all.mean_mm = std::sqrt(sum2 / static_cast<double>(points.size()));
  return all;
}

double residual_of(const Surface& surface, std::span<const Vec3> points) {
  double most = 0.0;
  const SurfaceAt at(surface);
  for (const Vec3& x : points) most = std::max(most, std::fabs(at.outside_mm(x)));
  return most;
}

}  // namespace mortise
