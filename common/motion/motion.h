#pragma once
#include <cstdint>

#include "common/math/pose.h"

namespace mortise {

enum class PathKind : std::uint8_t { kStill = 0, kLinear, kScrew };

/// The path of one part P in world W during one tick, t in [0, 1].
///   kLinear: the reference point moves straight with v_W, the part turns about it with constant
///   w_W (README, section 1); kScrew:  the part turns with constant w_W about the line through
///   axis_W and slides along it by pitch_mm.
/// Ends are exact: pose_at(0) is X_W0 and pose_at(1) is X_W1 to the last bit.
struct Motion {
  PathKind kind = PathKind::kStill;
  Pose X_W0, X_W1;
  Vec3 reference_P = Vec3::Zero();  ///< the point that moves straight, part frame
  Vec3 v_W =
      Vec3::Zero();  ///< mm per tick, of the reference point (kLinear) or along the axis (kScrew)
  Vec3 w_W = Vec3::Zero();     ///< rad per tick, |w| <= pi
  Vec3 axis_W = Vec3::Zero();  ///< a point of the axis at t = 0: reference point (kLinear), screw
                               ///< axis (kScrew)

  /// Before 0 the start, after 1 the end. t must be a number.
  Pose pose_at(double t) const;

  /// Upper bound, mm, of the path length of any point of the part over [t0, t1] whose distance from
  /// the reference point is at most radius_mm, which must not be negative.
  double travel_upper_bound_mm(double radius_mm, double t0, double t1) const;

  /// Velocity of the reference point at t, world axes, mm per tick. The part turns with w_W.
  Vec3 velocity_at(double t) const;

  /// Distance of the reference point from the axis of the rotation, mm: 0 for kLinear. A point r
  /// from the reference point is accelerated by at most |w|^2 (r + turn_radius_mm).
  double turn_radius_mm() const;

  bool moves() const { return kind != PathKind::kStill; }
};

/// A usable path: a known kind, valid poses, finite velocities, |w| <= pi.
bool valid(const Motion& motion);

/// Poses must be valid() here and below.
Motion still_motion(const Pose& X_W);
Motion linear_motion(const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P);
/// Screw between the poses; falls back to kLinear (whose path is then the same) when the rotation
/// is zero.
Motion screw_motion(const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P);

/// The motion seen from a frame B that stands still at X_WB: what first contact against a static
/// part works on.
Motion seen_from(const Motion& motion, const Pose& X_WB);

/// The same motion cut short: [0, 1] of the result is [0, t_end] of `motion`, ending exactly at
/// pose_at(t_end). t_end must be a number; beyond [0, 1] it is taken for the nearer end.
Motion until(const Motion& motion, double t_end);

}  // namespace mortise
