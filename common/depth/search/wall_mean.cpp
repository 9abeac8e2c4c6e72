#include "common/depth/search/wall_mean.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Halvings of the share in the search for the best one: to a thousandth.
constexpr int kShareSteps = 16;
// More than the sums of a mean of millimetres round off, mm.
constexpr double kMeanRounding_mm = 1e-9;

/// Shares s in [0, 1] of the second wall for which all means that were asked keep below the limit.
class Shares {
 public:
  explicit Shares(double limit_mm) : limit_mm_(limit_mm) {}
  /// (1 - s) first + s second <= limit.
  void keep(double first_mm, double second_mm) {
    const double at0 = first_mm - limit_mm_, slope = second_mm - first_mm;
    if (slope > 0.0)
      hi_ = std::min(hi_, -at0 / slope);
    else if (slope < 0.0)
      lo_ = std::max(lo_, -at0 / slope);
    else if (!(at0 <= 0.0))
      lo_ = 2.0;
  }
  bool any() const { return lo_ <= hi_; }

 private:
  double limit_mm_, lo_ = 0.0, hi_ = 1.0;
};

/// Depth of a circle's points below a wall: at most `middle_mm` + its point u of the unit circle
/// times `slope_mm` + any unit vector times `of_balls_mm`; and at most `most_mm`.
struct OnCircle {
  double middle_mm = kInfinity;
  Vec3 slope_mm = Vec3::Zero(), of_balls_mm = Vec3::Zero();
  double most_mm = kInfinity;
};

// What a point that goes around the circle can gain along `slope`, and one of a ball along
// `of_ball`.
double gain_mm(const Patch::Circle& circle, const Vec3& slope, const Vec3& of_ball) {
  return (slope - slope.dot(circle.axis) * circle.axis).norm() + of_ball.norm();
}

// Of one point of the circle, and one of a ball, the mean is a line over the shares, nowhere above
// that of all: of the points that are deepest at three shares.
void keep_points(const Patch::Circle& circle, const OnCircle& a, const OnCircle& b,
                 Shares& shares) {
  for (const double s : {0.0, 0.5, 1.0}) {
    const Vec3 slope = (1.0 - s) * a.slope_mm + s * b.slope_mm;
    const Vec3 u = (slope - slope.dot(circle.axis) * circle.axis).stableNormalized();
    const Vec3 of_ball = ((1.0 - s) * a.of_balls_mm + s * b.of_balls_mm).stableNormalized();
    shares.keep(a.middle_mm + a.slope_mm.dot(u) + a.of_balls_mm.dot(of_ball),
                b.middle_mm + b.slope_mm.dot(u) + b.of_balls_mm.dot(of_ball));
  }
}

OnCircle on_circle(const ConvexWall& wall, const Patch& patch, const Patch::Circle& circle) {
  OnCircle on;
  const double more =
      wall.offset_mm + patch.spread_mm + patch.neighbours_beyond(wall.normal, wall.turn_rad);
  if (wall.surface == nullptr) {
    on.middle_mm = more - wall.normal.dot(circle.center - wall.point);
    on.slope_mm = -circle.radius_mm * wall.normal;
    on.of_balls_mm = -circle.ball_mm * wall.normal;
    on.most_mm = on.middle_mm + gain_mm(circle, on.slope_mm, on.of_balls_mm);
    return on;
  }
  if (wall.surface->kind != SurfaceKind::kCylinder) return on;
  // Across the axis of the bore: with d the way from it to the centre and v that from there to the
  // point, |v| <= r, |d + v|^2 <= (r + d.u)^2 + |d|^2 and so |d + v| <= r + d.u + |d|^2 / 2(r -
  // |d|).
  const Vec3 from = circle.center - wall.surface->point;
  const Vec3 d = from - from.dot(wall.surface->axis) * wall.surface->axis;
  const double r = circle.radius_mm + circle.ball_mm, off = d.norm();
  on.most_mm = more + off + r - wall.surface->radius_mm;
  // Of a torus u is neither of the circle nor any.
  if (!(off < r) || (circle.radius_mm > 0.0 && circle.ball_mm > 0.0)) return on;
  on.middle_mm = more + r - wall.surface->radius_mm + 0.5 * off * off / (r - off);
  (circle.ball_mm > 0.0 ? on.of_balls_mm : on.slope_mm) = d;
  return on;
}

bool circles_keep_off(const ConvexWall& first, const ConvexWall& second, const Patch& patch,
                      double limit_mm) {
  if (patch.circle_count == 0) return false;
  std::array<OnCircle, 4> a, b;
  Shares shares(limit_mm);
  bool known = true;
  for (int i = 0; i < patch.circle_count; ++i) {
    a[i] = on_circle(first, patch, patch.circles[i]);
    b[i] = on_circle(second, patch, patch.circles[i]);
    if (!std::isfinite(a[i].most_mm) || !std::isfinite(b[i].most_mm)) return false;
    shares.keep(a[i].most_mm, b[i].most_mm);
    known = known && std::isfinite(a[i].middle_mm) && std::isfinite(b[i].middle_mm);
  }
  if (shares.any()) return true;
  if (!known) return false;
  Shares of_points(limit_mm + kMeanRounding_mm);
  for (int i = 0; i < patch.circle_count; ++i) keep_points(patch.circles[i], a[i], b[i], of_points);
  if (!of_points.any()) return false;
  // The largest mean is a convex function of the share.
  const auto largest = [&](double s) {
    double most = -kInfinity;
    for (int i = 0; i < patch.circle_count; ++i)
      most = std::max(most,
                      (1.0 - s) * a[i].middle_mm + s * b[i].middle_mm +
                          gain_mm(patch.circles[i], (1.0 - s) * a[i].slope_mm + s * b[i].slope_mm,
                                  (1.0 - s) * a[i].of_balls_mm + s * b[i].of_balls_mm));
    return most;
  };
  double lo = 0.0, hi = 1.0;
  for (int i = 0; i < kShareSteps; ++i) {
    const double third = (hi - lo) / 3.0, at_lo = largest(lo + third), at_hi = largest(hi - third);
    if (std::min(at_lo, at_hi) <= limit_mm) return true;
    (at_lo < at_hi ? hi : lo) = at_lo < at_hi ? hi - third : lo + third;
  }
  return false;
}

}  // namespace

bool mean_keeps_off(const ConvexWall& first, const ConvexWall& second, const Patch& patch,
                    double limit_mm) {
  Shares shares(limit_mm);
  const double beyond_first = patch.beyond(first.normal, first.turn_rad);
  const double beyond_second = patch.beyond(second.normal, second.turn_rad);
  for (int i = 0; i < patch.count && shares.any(); ++i)
    shares.keep(first.depth_mm(patch.points[i]) + beyond_first,
                second.depth_mm(patch.points[i]) + beyond_second);
  return shares.any() || circles_keep_off(first, second, patch, limit_mm);
}

}  // namespace mortise
