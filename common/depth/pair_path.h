#pragma once
#include "common/geometry/solid.h"
#include "common/math/pose.h"
#include "common/motion/motion.h"

namespace mortise {

/// A part of a tick.
struct Span {
  double t0 = 0.0, t1 = 1.0;
};

/// How two parts move relative to each other in one tick, with bounds for all of their points while
/// the parts are near each other. Role r looks at S = part r from K = part 1 - r. mm, rad, per
/// tick.
struct PairPath {
  Motion motions[2];
  double radius_mm[2];  ///< no point of a part is farther from its reference point

  PairPath(const Motion& a, const Solid& solid_a, const Motion& b, const Solid& solid_b)
      : motions{a, b}, radius_mm{reach_mm(a, solid_a), reach_mm(b, solid_b)} {}

  static double reach_mm(const Motion& motion, const Solid& solid) {
    const BoundingSphere& sphere = solid.sphere();
    if (!motion.moves()) return sphere.radius_mm;
    return (sphere.center_mm - motion.reference_P).norm() + sphere.radius_mm;
  }

  /// Relative pose X_KS at t.
  Pose pose(int role, double t) const {
    return motions[1 - role].pose_at(t).inverse() * motions[role].pose_at(t);
  }

  /// No point of either part moves faster relative to the other part.
  double speed_upper_bound() const {
    // Points of A seen from B's reference point: both spheres, and the gap between their centres.
    const double reach = 2.0 * (radius_mm[0] + radius_mm[1]);
    return motions[0].travel_upper_bound_mm(radius_mm[0], 0.0, 1.0) +
           motions[1].travel_upper_bound_mm(reach, 0.0, 1.0);
  }

  /// A point of S seen from K: |x''| <= |x_S''| + 2 |w_K| |v| + |w_K|^2 d.
  double acceleration_upper_bound(int role) const {
    const Motion &s = motions[role], &k = motions[1 - role];
    const double ws = s.w_W.norm(), wk = k.w_W.norm();
    if (ws == 0.0 && wk == 0.0) return 0.0;
    const double rs = 2.0 * radius_mm[role] + s.turn_radius_mm();
    const double d = 2.0 * (radius_mm[0] + radius_mm[1]) + k.turn_radius_mm();
    const double vs = s.travel_upper_bound_mm(2.0 * radius_mm[role], 0.0, 1.0);
    const double vk = k.travel_upper_bound_mm(d, 0.0, 1.0);
    return ws * ws * rs + 2.0 * wk * (vs + vk) + wk * wk * d;
  }

  /// Every point of S stays this close to the straight line between its ends over the span.
  double spread(int role, const Span& span) const {
    const double dt = span.t1 - span.t0;
    return acceleration_upper_bound(role) * dt * dt / 8.0;
  }

  /// No direction turns by more over the span.
  double turn(const Span& span) const {
    return (motions[0].w_W.norm() + motions[1].w_W.norm()) * (span.t1 - span.t0);
  }
};

}  // namespace mortise
