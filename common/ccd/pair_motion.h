#pragma once
#include "common/ccd/box_advance.h"
#include "common/ccd/first_contact.h"

// Two bodies during one tick, seen from B.
namespace mortise::ccd {

/// One body of the pair at a time t, in axes of B, relative to the origin of B's tree.
struct BodyState {
  Vec3 v = Vec3::Zero();     ///< velocity of the origin of the body's tree, world, mm per tick
  Vec3 w = Vec3::Zero();     ///< rotation vector, rad per tick
  Vec3 axis = Vec3::Zero();  ///< unit
  Vec3 arm = Vec3::Zero();   ///< from the axis of rotation to the origin of the tree, across it
};

/// Both bodies at time t. A point u of A (relative to the origin of A's tree, part axes) is at
/// R u + p; points of B are taken relative to the origin of B's tree. Velocities are those of the
/// world, only written in axes of B: a direction n that is kept fixed in the world while time
/// advances gives gap(t + dt) >= gap - s dt - bend dt^2 / 2 (ALG 2.1 B3', both bodies: A2).
struct PairState {
  double t = -1.0;
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();
  BodyState a, b;
};

class PairMotion {
 public:
  PairMotion(const Solid& a, const Motion& motion_a, const Solid& b, const Motion& motion_b);

  /// State at t; remembered until another t is asked for.
  const PairState& at(double t);
  /// What the box kernels need at state.t.
  const BoxFrame& frame(double target_mm);

  const PairState& state() const { return state_; }
  bool turns_a() const { return speed_a_ > 0.0; }
  bool turns_b() const { return speed_b_ > 0.0; }
  double speed_a() const { return speed_a_; }  ///< |w|
  double speed_b() const { return speed_b_; }
  /// Rounding of any coordinate or distance of the pair, mm: 32 u (L + D) (ALG 2.12).
  double rounding_mm() const { return rounding_mm_; }
  /// Rounding of a speed along a direction, mm per tick.
  double speed_rounding_mm() const { return speed_rounding_mm_; }
  Vec3 to_world(const Vec3& x_local_b, double t) const;

 private:
  const Solid& solid_a_;
  const Solid& solid_b_;
  Motion world_b_;
  Motion motion_a_, motion_b_;  // A seen from B when B is still, else both in the world
  bool b_still_;
  double speed_a_, speed_b_;
  double rounding_mm_, speed_rounding_mm_, largest_speed_mm_;
  Vec3 origin_a_, origin_b_;
  double radius_a_, radius_b_;
  PairState state_;
  BoxFrame frame_{};
  double frame_t_ = -1.0, frame_target_ = 0.0;
};

}  // namespace mortise::ccd
