#include "common/ccd/pair_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::ccd {
namespace {

// Float arithmetic of one box test makes at most some thirty errors of half an ulp, 6e-8 of the
// extent.
constexpr double kFloatRounding = 2e-6;

float rounded_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

void copy(const Vec3& from, float* to) {
  for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(from[c]);
}

BodyState body_state(const Motion& motion, const Pose& X_WP, const Vec3& origin_P, double t) {
  BodyState state;
  if (!motion.moves()) return state;
  const Vec3 reference_to_origin = X_WP.q * (origin_P - motion.reference_P);
  state.v = motion.velocity_at(t);
  const double speed = motion.w_W.norm();
  if (speed == 0.0) return state;
  state.w = motion.w_W;
  state.axis = motion.w_W / speed;
  state.v += state.w.cross(reference_to_origin);
  const Vec3 axis_point =
      motion.kind == PathKind::kScrew ? motion.axis_W : Vec3(motion.axis_W + t * motion.v_W);
  const Vec3 arm =
      motion.kind == PathKind::kScrew ? Vec3(X_WP * origin_P - axis_point) : reference_to_origin;
  state.arm = arm - arm.dot(state.axis) * state.axis;
  return state;
}

void rotate(BodyState& state, const Mat3& R) {
  state.v = R * state.v;
  state.w = R * state.w;
  state.axis = R * state.axis;
  state.arm = R * state.arm;
}

double largest_speed(const Motion& motion, double radius, const Vec3& origin_P) {
  return motion.travel_upper_bound_mm(radius + (origin_P - motion.reference_P).norm(), 0.0, 1.0);
}

}  // namespace

PairMotion::PairMotion(const Solid& a, const Motion& motion_a, const Solid& b,
                       const Motion& motion_b)
    : solid_a_(a),
      solid_b_(b),
      world_b_(motion_b),
      motion_a_(motion_a),
      motion_b_(motion_b),
      b_still_(!motion_b.moves()),
      speed_a_(motion_a.w_W.norm()),
      speed_b_(motion_b.w_W.norm()),
      origin_a_(a.bvh().origin),
      origin_b_(b.bvh().origin),
      radius_a_(a.bvh().radius_mm),
      radius_b_(b.bvh().radius_mm) {
  // Nothing that a body never does costs anything later.
  if (!motion_a.moves()) speed_a_ = 0.0;
  if (b_still_) {
    speed_b_ = 0.0;
    motion_a_ = seen_from(motion_a, motion_b.X_W0);
    motion_b_ = still_motion(Pose{});
  }
  const auto size = [](const Motion& motion) {
    return std::max(motion.X_W0.p.norm(), motion.X_W1.p.norm());
  };
  const double extent = a.bvh().extent_mm + b.bvh().extent_mm + size(motion_a) + size(motion_b);
  rounding_mm_ = kRoundingFactor * kUnitRoundoff * extent;
  largest_speed_mm_ = largest_speed(motion_a_, radius_a_, origin_a_) +
                      largest_speed(motion_b_, radius_b_, origin_b_);
  speed_rounding_mm_ =
      kRoundingFactor * kUnitRoundoff * (largest_speed_mm_ + extent * (speed_a_ + speed_b_));
}

const PairState& PairMotion::at(double t) {
  if (state_.t == t) return state_;
  state_.t = t;
  const Pose X_WA = motion_a_.pose_at(t);
  state_.a = body_state(motion_a_, X_WA, origin_a_, t);
  if (b_still_) {
    state_.R = X_WA.rotation();
    state_.p = X_WA * origin_a_ - origin_b_;
    return state_;
  }
  const Pose X_WB = motion_b_.pose_at(t);
  state_.b = body_state(motion_b_, X_WB, origin_b_, t);
  const Mat3 R_BW = X_WB.rotation().transpose();
  state_.R = R_BW * X_WA.rotation();
  // The translations are subtracted first: far from the world's origin nothing else is lost.
  state_.p = R_BW * ((X_WA.p - X_WB.p) + X_WA.q * origin_a_) - origin_b_;
  rotate(state_.a, R_BW);
  rotate(state_.b, R_BW);
  return state_;
}

const BoxFrame& PairMotion::frame(double target_mm) {
  if (frame_t_ == state_.t && frame_target_ == target_mm) return frame_;
  frame_t_ = state_.t;
  frame_target_ = target_mm;
  BoxFrame& f = frame_;
  const PairState& s = state_;
  f.turns_a = turns_a();
  f.turns_b = turns_b();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      f.r[i][j] = static_cast<float>(s.R(i, j));
      f.abs_r[i][j] = std::fabs(f.r[i][j]);
    }
  copy(s.p, f.p);
  const Vec3 v = s.a.v - s.b.v;
  copy(v, f.v);
  copy(s.a.w, f.w_a);
  copy(s.b.w, f.w_b);
  copy(s.a.axis, f.axis_a);
  copy(s.b.axis, f.axis_b);
  copy(s.a.arm, f.arm_a);
  copy(s.b.arm, f.arm_b);
  f.speed_a = rounded_up(speed_a_);
  f.speed_b = rounded_up(speed_b_);
  const double extent = radius_a_ + radius_b_ + s.p.norm();
  f.gap_allowance = rounded_up(std::max(target_mm, 0.0) + rounding_mm_ + kFloatRounding * extent);
  f.speed_allowance =
      rounded_up(speed_rounding_mm_ +
                 kFloatRounding * (v.norm() + speed_a_ * radius_a_ + speed_b_ * radius_b_));
  f.arm_allowance =
      rounded_up(kFloatRounding * (radius_a_ + radius_b_ + s.a.arm.norm() + s.b.arm.norm()));
  for (int k = 0; k < 6; ++k) {
    const Vec3 n = k < 3 ? Vec3(Vec3::Unit(k)) : Vec3(s.R.col(k - 3));
    DirectionTerms& d = f.direction[k];
    copy(n, d.n);
    d.v = static_cast<float>(n.dot(v));
    if (f.turns_a) {
      const Vec3 turn = n.cross(s.a.w);
      copy(turn, d.turn_a);
      copy((s.R.transpose() * turn).cwiseAbs(), d.reach_a);
      d.bend_a = rounded_up(turn.norm() * speed_a_);
    }
    if (f.turns_b) {
      const Vec3 turn = n.cross(s.b.w);
      copy(turn, d.turn_b);
      d.bend_b = rounded_up(turn.norm() * speed_b_);
    }
  }
  return f;
}

Vec3 PairMotion::to_world(const Vec3& x_local_b, double t) const {
  return world_b_.pose_at(t) * (x_local_b + origin_b_);
}

}  // namespace mortise::ccd
