#include "tests/bench/judgement_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mortise::bench {
namespace {

using std::numbers::pi;
constexpr double kNowhere = -std::numeric_limits<double>::infinity();
// A fit that touches exactly (h6 in H7) must not be called open by the last digit of a sum.
constexpr double kRounding_mm = 1e-9;

// Largest value of a continuous function of an angle: a coarse grid, then golden sections about
// every local best of it.
template <class F>
double largest_over_angles(F&& f) {
  constexpr int kGrid = 96;
  constexpr double kGolden = 0.6180339887498949;
  double values[kGrid];
  for (int i = 0; i < kGrid; ++i) values[i] = f(2.0 * pi * i / kGrid);
  double best = *std::max_element(values, values + kGrid);
  for (int i = 0; i < kGrid; ++i) {
    if (values[i] < values[(i + kGrid - 1) % kGrid] || values[i] < values[(i + 1) % kGrid])
      continue;
    double lo = 2.0 * pi * (i - 1) / kGrid, hi = 2.0 * pi * (i + 1) / kGrid;
    double x = hi - kGolden * (hi - lo), y = lo + kGolden * (hi - lo);
    double fx = f(x), fy = f(y);
    while (hi - lo > 1e-9) {
      if (fx > fy) {
        hi = y, y = x, fy = fx;
        fx = f(x = hi - kGolden * (hi - lo));
      } else {
        lo = x, x = y, fx = fy;
        fy = f(y = lo + kGolden * (hi - lo));
      }
      best = std::max({best, fx, fy});
    }
  }
  return best;
}

double slope_of(const Frustum& f) { return (f.r1_mm - f.r0_mm) / (f.z1_mm - f.z0_mm); }

}  // namespace

double round_overlap_mm(const RoundFit& fit, const Offsets& offsets) {
  // 1. the moved shaft and hole
  const double slope = slope_of(fit.hole);
  const double cosine = 1.0 / std::hypot(1.0, slope);
  const double z0 = fit.shaft.z0_mm - offsets.rest_a, z1 = fit.shaft.z1_mm + offsets.rest_a;
  const double wider = offsets.a / cosine;
  const double r0 = fit.shaft.r0_mm + slope * (z0 - fit.shaft.z0_mm) + wider;
  const double r1 = fit.shaft.r1_mm + slope * (z1 - fit.shaft.z1_mm) + wider;
  const double lower = fit.hole.z0_mm - offsets.rest_b, upper = fit.hole.z1_mm + offsets.rest_b;
  // 2. one generatrix, cut where the hole ends
  return largest_over_angles([&](double angle) {
    const Vec3 p0 = fit.X_BA * shapes::on_circle(r0, angle, z0);
    const Vec3 p1 = fit.X_BA * shapes::on_circle(r1, angle, z1);
    const double rise = p1.z() - p0.z();
    double t0 = 0.0, t1 = 1.0;
    if (rise != 0.0) {
      const double at_lower = (lower - p0.z()) / rise, at_upper = (upper - p0.z()) / rise;
      t0 = std::max(t0, std::min(at_lower, at_upper));
      t1 = std::min(t1, std::max(at_lower, at_upper));
    }
    if (t0 > t1) return kNowhere;
    const auto beyond = [&](double t) {
      const Vec3 p = p0 + t * (p1 - p0);
      const double radius = fit.hole.r0_mm + slope * (p.z() - fit.hole.z0_mm);
      return (std::hypot(p.x(), p.y()) - radius) * cosine + offsets.b;
    };
    return std::max(beyond(t0), beyond(t1));
  });
}

bool deepest_below_rim(const BallFit& fit) {
  const double apart = fit.center.norm();
  return apart == 0.0 ||
         fit.center.z() * (1.0 + fit.ball_mm / apart) < fit.rim_z_mm - 0.02 * fit.ball_mm;
}

double ball_overlap_mm(const BallFit& fit, const Offsets& offsets) {
  const double ball = fit.ball_mm + offsets.a, socket = fit.socket_mm - offsets.b;
  const double rim = fit.rim_z_mm + offsets.rest_b;
  const double apart = fit.center.norm();
  if (apart == 0.0) return ball - socket;
  if (fit.center.z() * (1.0 + ball / apart) <= rim) return apart + ball - socket;
  const double up = rim - fit.center.z();
  const double circle = std::sqrt(std::max(0.0, ball * ball - up * up));
  return std::hypot(rim, std::hypot(fit.center.x(), fit.center.y()) + circle) - socket;
}

double key_overlap_mm(const KeyFit& fit, const Offsets& offsets) {
  const double half_width = (fit.key_half_mm.x() + offsets.a) * std::cos(fit.yaw_rad) +
                            fit.key_half_mm.z() * std::abs(std::sin(fit.yaw_rad));
  const double wall = std::abs(fit.center.x()) + half_width - fit.slot.half_width_mm + offsets.b;
  const double floor = fit.key_half_mm.y() + offsets.a - fit.center.y() + offsets.b;
  return wall > 0.0 && floor > 0.0 ? std::hypot(wall, floor) : std::max(wall, floor);
}

double polygon_depth_mm(const PolygonFit& fit) {
  const auto corners = [](double radius, const Around& around, const Vec3& axis, double turn) {
    std::vector<Vec3> points;
    for (int i = 0; i < around.facets; ++i)
      points.push_back(
          axis +
          shapes::on_circle(radius, 2.0 * pi * i / around.facets + around.phase_rad + turn, 0.0));
    return points;
  };
  const std::vector<Vec3> shaft = corners(fit.shaft_mm, fit.shaft, fit.axis, fit.turn_rad);
  const std::vector<Vec3> hole = corners(fit.hole_mm, fit.around_hole, Vec3::Zero(), 0.0);
  double depth = kNowhere;
  for (const Vec3& p : shaft) {
    // Signed distance of the corner from the hole's polygon, positive outside.
    double inside = kNowhere, nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hole.size(); ++i) {
      const Vec3 q = hole[i], along = hole[(i + 1) % hole.size()] - q;
      const Vec3 outward = Vec3(along.y(), -along.x(), 0.0).normalized();
      const double t = std::min(1.0, std::max(0.0, along.dot(p - q) / along.squaredNorm()));
      inside = std::max(inside, outward.dot(p - q));
      nearest = std::min(nearest, (p - q - t * along).norm());
    }
    depth = std::max(depth, inside > 0.0 ? nearest : inside);
  }
  return depth;
}

CollisionClass Truth::collision_class() const {
  if (certain_mm > kRounding_mm) return CollisionClass::kReal;
  return possible_mm > kRounding_mm ? CollisionClass::kPotential : CollisionClass::kNone;
}

double Truth::margin_mm() const { return std::min(std::abs(certain_mm), std::abs(possible_mm)); }

}  // namespace mortise::bench
