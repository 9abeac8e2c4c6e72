#pragma once
#include <algorithm>

#include "common/ccd/first_contact.h"
#include "common/ccd/kernels/kernels.h"

// Two bodies during one tick, seen from B.
namespace mortise::ccd {

/// The path of one body, in closed form from what does not change during the tick
/// (motion/README.md); places are those of the origin of the body's tree, axes those in which the
/// path was given.
class BodyPath {
 public:
  BodyPath() = default;
  /// `origin`: where the origin of the tree is at t = 0.
  BodyPath(const Motion& motion, const Vec3& origin, const Vec3& from_reference);

  void at(double t, Mat3& R, Vec3& origin, Vec3& arm) const;

  const Vec3& v() const { return v_; }     ///< velocity of the axis of rotation, mm per tick
  const Vec3& w() const { return w_; }     ///< rotation vector, rad per tick
  double speed() const { return speed_; }  ///< |w|

 private:
  Mat3 R0_ = Mat3::Identity(), KR0_ = Mat3::Zero(), KKR0_ = Mat3::Zero();
  Vec3 origin0_ = Vec3::Zero(), v_ = Vec3::Zero(), w_ = Vec3::Zero();
  Vec3 side_ = Vec3::Zero(), inward_ = Vec3::Zero();  // axis x r, axis x (axis x r)
  double speed_ = 0.0;
};

/// One body of the pair at a time t, in axes of B, relative to the origin of B's tree.
struct BodyState {
  Vec3 v = Vec3::Zero();    ///< velocity of the axis of rotation, world, mm per tick
  Vec3 w = Vec3::Zero();    ///< rotation vector, rad per tick
  Vec3 arm = Vec3::Zero();  ///< from the axis of rotation to the origin of the tree, across it
};

/// Both bodies at time t. A point u of A (relative to the origin of A's tree, part axes) is at
/// R u + p; points of B are taken relative to the origin of B's tree. Velocities are those of the
/// world, only written in axes of B: a direction n is kept fixed in the world while time advances
/// (README, section 2; the bound: TurnTerms in leaf_kernel.h).
struct PairState {
  double t = -1.0;
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();
  BodyState a, b;
};

/// The axes in which boxes of one part are given: a point x (part axes, from the origin of the
/// tree) is at axes (x - from_origin), and no farther than radius_mm from there.
struct BoxAxes {
  const Mat3* axes = nullptr;  ///< null: those of the part
  Vec3 from_origin = Vec3::Zero();
  double radius_mm = 0.0;
};

class PairMotion {
 public:
  PairMotion(const Solid& a, const Motion& motion_a, const Solid& b, const Motion& motion_b);

  /// State at t; remembered until another t is asked for.
  const PairState& at(double t);
  /// What the box kernels need at state.t, for boxes in axes of the parts.
  const BoxFrame& frame(double target_mm);
  /// The same for boxes in axes of their own.
  const BoxFrame& frame(double target_mm, const BoxAxes& a, const BoxAxes& b);
  /// As far as kernels read it that take places alone.
  const BoxFrame& still_frame(const BoxAxes& a, const BoxAxes& b);
  /// What the leaf kernel needs at state.t. Gaps are measured from taken_mm + rounding.
  const LeafFrame& leaf_frame(double taken_mm, double suspect_mm);

  const PairState& state() const { return state_; }
  bool turns_a() const { return path_a_.speed() > 0.0; }
  bool turns_b() const { return path_b_.speed() > 0.0; }
  /// Of the body that turns faster, rad per tick.
  double turning() const { return std::max(path_a_.speed(), path_b_.speed()); }
  /// Rounding of any coordinate or distance of the pair, mm: 32 u (L + D) (README, section 4).
  double rounding_mm() const { return rounding_mm_; }
  /// Rounding of a speed along a direction, mm per tick.
  double speed_rounding_mm() const { return speed_rounding_mm_; }
  /// Upper bound of the ways of both bodies, mm.
  double travel_mm() const { return travel_mm_; }
  Vec3 to_world(const Vec3& x_local_b, double t) const;

 private:
  void set_bounds(TurnTerms& terms, double speed, double horizon) const;
  double horizon() const;

  const Solid& solid_b_;
  Motion world_b_;
  bool b_still_;
  BodyPath path_a_, path_b_;
  double rounding_mm_, speed_rounding_mm_, travel_mm_;
  double radius_a_, radius_b_;
  PairState state_;
  BoxFrame frame_;  // the terms of a body that does not turn are never read
  double frame_t_ = -1.0, frame_target_ = 0.0;  // of the frame in axes of the parts
  BoxFrame still_frame_;
  LeafFrame leaf_{};
  double leaf_t_ = -1.0;
};

}  // namespace mortise::ccd
