#pragma once

// For how long the triangles of one leaf stay apart from those of another, four at once. Double
// precision, but it may only discard: what it cannot free is named as suspect and left to the
// scalar code. No Eigen type here: this header is compiled for different instruction sets.
namespace mortise::ccd {

/// Corners of the triangles of a leaf: [corner][coordinate][triangle], mm, relative to the origin
/// of the tree. Unused lanes repeat triangle 0.
struct LeafCorners {
  alignas(32) double at[3][3][4];
  int count = 0;
};

/// Two bodies at one time t, in axes of B, relative to the origin of B's tree; mm, rad, ticks.
/// A point at e from the axis of a body that turns with w, whose axis moves with v, goes along a
/// direction n (fixed while time advances by dt, phi = |w| dt) by
///   n.v dt + n.(w x e) sin(phi) / |w| + n.(w x (w x e)) (1 - cos(phi)) / |w|^2,
/// exactly. Below the horizon T, 1 - cos(phi) >= bow phi^2 / 2 and sin(phi) >= phi - phi^3 / 6,
/// and (|w| dt)^3 <= |w|^3 T dt^2, so that
///   s = n.v + n.(w x e),
///   bend = n.(w x (w x e)) (times bow where negative) + lift |n.(w x e)| (where that is negative)
/// bound it from above by s dt + bend dt^2 / 2. Unlike a bound by |w|^2 times the distance from the
/// axis, bend is negative where a point turns away from the other part: a shaft that turns in its
/// bore is free for the whole tick in one step.
struct TurnTerms {
  double w[3] = {0.0, 0.0, 0.0};
  double arm[3] = {0.0, 0.0, 0.0};  ///< from the axis of rotation to the origin of A's / B's tree
  double bow = 1.0;                 ///< 1 - (|w| T)^2 / 12
  double lift = 0.0;                ///< |w|^2 T / 3
  bool turns = false;
};

struct LeafFrame {
  double r[3][3], p[3];  ///< a point u of A is at r u + p
  double v[3];           ///< velocity of A's axis less that of B's
  TurnTerms a, b;
  double horizon;      ///< ticks; the bounds hold for no longer
  double speed_slack;  ///< rounding of a speed, mm per tick
  double bend_slack;   ///< rounding of an acceleration, mm per tick^2
  double sweep;        ///< 2 |w_A x v|: see LeafKernel
  double taken_mm;     ///< target and rounding, taken off every gap
  double suspect_mm;   ///< at or below this gap a pair of triangles is suspect
};

struct LeafAnswer {
  double dt = 0.0;        ///< all pairs but the suspect ones stay above the target for so long
  unsigned suspects = 0;  ///< bit 4 i + j: triangle i of A and j of B
};

/// `enough`: a longer time is of no use, the kernel may stop there.
///
/// Where B does not turn the directions may as well turn with A: seen from there the points of B
/// move, by the inverse motion, and bend the other way. Of v only the part along the axis is the
/// same in every direction; the other turns with the frame, |n| |v_across| |w| dt^2 = sweep dt^2 /
/// 2 at most. The kernel takes the view from which the leaf of A turns away.
using LeafKernel = LeafAnswer (*)(const LeafFrame& frame, const LeafCorners& a,
                                  const LeafCorners& b, double enough);

}  // namespace mortise::ccd
