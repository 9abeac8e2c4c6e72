#pragma once
#include <functional>
#include <vector>

#include "common/math/pose.h"
#include "common/messages/event.h"
#include "tests/bench/judgement_parts.h"
#include "tests/support/shapes.h"

/// Closed forms of the overlap of two true parts, without any mesh. mm; positive exactly when the
/// interiors meet. Outward offsets of the material as everywhere: the hole gets narrower by b.
namespace mortise::bench {

/// By how much the faces of both parts are moved: those that fit each other, and all others.
struct Offsets {
  double a = 0.0, b = 0.0;            ///< of the faces that a statement speaks of
  double rest_a = 0.0, rest_b = 0.0;  ///< of end faces and rims
};

/// A conical or cylindrical shaft in such a hole of the same angle, any relative pose in which it
/// meets the wall only. The distance from the hole's surface is convex over the shaft, so that it
/// is largest on the end circles or where the hole ends: the larger of both ends of one
/// generatrix, searched over the angle. Exact to rounding; with parallel axes it is the depth
/// delta, for tilted ones its sign (delta is less by the tilt's share at a rim).
struct RoundFit {
  Frustum shaft, hole;
  Pose X_BA;
};
double round_overlap_mm(const RoundFit& fit, const Offsets& offsets);

/// Ball in a socket that is open above z = rim; centre of the ball from the socket's. Exact depth
/// when the deepest point is below the rim.
struct BallFit {
  double ball_mm, socket_mm, rim_z_mm;
  Vec3 center;
};
double ball_overlap_mm(const BallFit& fit, const Offsets& offsets);
bool deepest_below_rim(const BallFit& fit);

/// Key, turned by yaw about y, in a slot: the deepest of its corners beyond walls and floor. Exact
/// depth. Faces without a statement do not touch.
struct KeyFit {
  Vec3 key_half_mm;
  Slot slot;
  Vec3 center;
  double yaw_rad;
};
double key_overlap_mm(const KeyFit& fit, const Offsets& offsets);

/// Depth delta of two regular polygonal prisms with parallel axes, the first in a hole of the
/// second's shape: farthest corner of the first from the second polygon, which is convex; < 0: the
/// least distance of corners and edges inside. `axis` is where A's axis stands, `turn_rad` by how
/// much A's corners are turned, both in frame B.
struct PolygonFit {
  double shaft_mm, hole_mm;  ///< radii of the corners
  Around shaft, around_hole;
  Vec3 axis;
  double turn_rad;
};
double polygon_depth_mm(const PolygonFit& fit);

/// What all admissible surfaces say together: depth of the least and of the largest parts.
struct Truth {
  double certain_mm = 0.0, possible_mm = 0.0;
  /// kReal, kPotential, or kNone for what cannot interfere (an overlap of the meshes is then fake).
  CollisionClass collision_class() const;
  /// Distance to the nearer threshold.
  double margin_mm() const;
};

}  // namespace mortise::bench
