#include "common/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

// Below this angle the bulge of a screw path over its chord, chord * angle / 8, is less than
// rounding.
constexpr double kStraight_rad = 1e-15;

// (R - I) r for the rotation vector w: the shift that a turn gives to r. Keeps its relative
// precision when the axis is far away and the angle small, where R r - r would cancel.
Vec3 turned_minus_still(const Vec3& w, const Vec3& r) {
  const double angle = w.norm();
  if (angle == 0.0) return Vec3::Zero();
  const Vec3 axis = w / angle;
  const Vec3 side = axis.cross(r);
  const double half_sine = std::sin(0.5 * angle);
  return std::sin(angle) * side + 2.0 * half_sine * half_sine * axis.cross(side);
}

}  // namespace

Pose Motion::pose_at(double t) const {
  MORTISE_CHECK(!std::isnan(t), "a time must be a number");
  if (kind == PathKind::kStill || t <= 0.0) return X_W0;
  if (t >= 1.0) return X_W1;
  const Vec3 reference_0 = X_W0 * reference_P;
  Vec3 reference_t = reference_0 + t * v_W;
  Pose X_Wt{X_W0.q, X_W0.p + t * v_W};
  if (w_W.isZero(0.0)) return X_Wt;
  if (kind == PathKind::kScrew) reference_t += turned_minus_still(t * w_W, reference_0 - axis_W);
  X_Wt.q = (rotation_exp(t * w_W) * X_W0.q).normalized();
  X_Wt.p = reference_t - X_Wt.q * reference_P;
  return X_Wt;
}

Vec3 Motion::velocity_at(double t) const {
  if (kind != PathKind::kScrew) return v_W;
  const Vec3 r0 = X_W0 * reference_P - axis_W;
  return v_W + w_W.cross(r0 + turned_minus_still(t * w_W, r0));
}

double Motion::turn_radius_mm() const {
  if (kind != PathKind::kScrew) return 0.0;
  const Vec3 axis = w_W.normalized();
  const Vec3 r0 = X_W0 * reference_P - axis_W;
  return (r0 - r0.dot(axis) * axis).norm();
}

double Motion::travel_upper_bound_mm(double radius_mm, double t0, double t1) const {
  MORTISE_CHECK(radius_mm >= 0.0 && !std::isnan(t1 - t0), "a radius and times must be numbers");
  if (kind == PathKind::kStill) return 0.0;
  const double turning = w_W.norm() * (radius_mm + turn_radius_mm());
  // On a screw the two speeds are perpendicular; on a linear path they may add up.
  const double speed =
      kind == PathKind::kScrew ? std::hypot(v_W.norm(), turning) : v_W.norm() + turning;
  return speed * std::max(0.0, t1 - t0);
}

bool valid(const Motion& motion) {
  if (!valid(motion.X_W0)) return false;
  if (motion.kind == PathKind::kStill) return true;
  if (motion.kind != PathKind::kLinear && motion.kind != PathKind::kScrew) return false;
  // Rounding of the logarithm at half a turn: a few ulp. Sums that are no numbers are not below.
  constexpr double kHalfTurn = kMaxRotationPerTick_rad * (1.0 + 8.0 * kUnitRoundoff);
  return valid(motion.X_W1) && motion.w_W.squaredNorm() <= kHalfTurn * kHalfTurn &&
         motion.v_W.squaredNorm() + motion.axis_W.squaredNorm() + motion.reference_P.squaredNorm() <
             std::numeric_limits<double>::infinity();
}

Motion still_motion(const Pose& X_W) {
  MORTISE_CHECK(valid(X_W), "a pose must be finite and its quaternion unit");
  Motion motion;
  motion.X_W0 = motion.X_W1 = X_W;
  motion.axis_W = X_W.p;
  return motion;
}

Motion linear_motion(const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P) {
  MORTISE_CHECK(valid(X_W0) && valid(X_W1), "poses must be finite and their quaternions unit");
  MORTISE_CHECK((reference_P.array().abs() <= kLargestCoordinate_mm).all(),
                "a reference point must be finite");
  Motion motion;
  motion.X_W0 = X_W0;
  motion.X_W1 = X_W1;
  motion.reference_P = reference_P;
  motion.axis_W = X_W0 * reference_P;
  if (identical(X_W0, X_W1)) return motion;
  motion.kind = PathKind::kLinear;
  const bool same_turn = (X_W0.q.coeffs().array() == X_W1.q.coeffs().array()).all();
  if (same_turn) {
    motion.v_W = X_W1.p - X_W0.p;
  } else {
    motion.v_W = X_W1 * reference_P - motion.axis_W;
    motion.w_W = rotation_log((X_W1.q * X_W0.q.conjugate()).normalized());
  }
  return motion;
}

Motion screw_motion(const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P) {
  Motion motion = linear_motion(X_W0, X_W1, reference_P);
  const double angle = motion.w_W.norm();
  if (!(angle > kStraight_rad)) return motion;
  // The chord across the axis subtends `angle` from it (Chasles).
  const Vec3 axis = motion.w_W / angle;
  const double pitch_mm = motion.v_W.dot(axis);
  const Vec3 across = motion.v_W - pitch_mm * axis;
  const Vec3 middle = motion.axis_W + 0.5 * across;
  motion.kind = PathKind::kScrew;
  // tan(pi/2) is finite in doubles and its inverse 6e-17: half a turn needs no case of its own.
  motion.axis_W = middle + axis.cross(across) * (0.5 / std::tan(0.5 * angle));
  motion.v_W = pitch_mm * axis;
  return motion;
}

Motion seen_from(const Motion& motion, const Pose& X_WB) {
  MORTISE_CHECK(valid(X_WB), "a pose must be finite and its quaternion unit");
  const Pose X_BW = X_WB.inverse();
  Motion seen = motion;
  seen.X_W0 = X_BW * motion.X_W0;
  seen.X_W1 = X_BW * motion.X_W1;
  seen.v_W = X_BW.q * motion.v_W;
  seen.w_W = X_BW.q * motion.w_W;
  seen.axis_W = X_BW * motion.axis_W;
  return seen;
}

Motion until(const Motion& motion, double t_end) {
  MORTISE_CHECK(!std::isnan(t_end), "a time must be a number");
  if (t_end >= 1.0 || !motion.moves()) return motion;
  if (t_end <= 0.0) return still_motion(motion.X_W0);
  Motion cut = motion;
  cut.X_W1 = motion.pose_at(t_end);
  cut.v_W *= t_end;
  cut.w_W *= t_end;
  return cut;
}

}  // namespace mortise
