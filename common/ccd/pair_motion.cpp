#include "common/ccd/pair_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::ccd {
namespace {

// A bound along a direction holds while a body turns by no more than this (see TurnTerms): what it
// gives away at the end is a 25th of the speed by turning. Ticks seldom turn as far.
constexpr double kHorizon_rad = 1.0;

// Float arithmetic of one box test makes at most some forty errors of half an ulp, 6e-8 of the
// extent.
constexpr double kFloatRounding = 3e-6;

// Of a value that is not negative: at least x, at most three ulp more.
float rounded_up(double x) { return static_cast<float>(x) * (1.0F + 0x1p-22F); }

template <class Vector, class Scalar>
void copy(const Vector& from, Scalar* to) {
  const Vec3 x = from;
  for (int c = 0; c < 3; ++c) to[c] = static_cast<Scalar>(x[c]);
}

// The pair in axes of the boxes of B, from their origin; see BoxFrame.
struct SeenFromBoxes {
  Mat3 R;
  Vec3 p, v, w_a, arm_a, w_b, arm_b;

  SeenFromBoxes(const PairState& s, const BoxAxes& boxes_a, const BoxAxes& boxes_b) {
    const Vec3 from_origin_a = s.R * boxes_a.from_origin;
    R = s.R;
    p = s.p + from_origin_a - boxes_b.from_origin;
    v = s.a.v - s.b.v;
    w_a = s.a.w;
    arm_a = s.a.arm + from_origin_a;
    w_b = s.b.w;
    arm_b = s.b.arm + boxes_b.from_origin;
    if (boxes_a.axes != nullptr) R = R * boxes_a.axes->transpose();
    if (boxes_b.axes == nullptr) return;
    const Mat3& N = *boxes_b.axes;
    R = N * R;
    for (Vec3* x : {&p, &v, &w_a, &arm_a, &w_b, &arm_b}) *x = N * *x;
  }
};

void set_axes(BoxFrame& f, const Mat3& R) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      f.r[i][j] = static_cast<float>(R(i, j));
      f.abs_r[i][j] = std::fabs(f.r[i][j]);
    }
}

void set_turn(BoxTurn& turn, const TurnTerms& terms, const Mat3& R, const Vec3& w, const Vec3& arm,
              double speed) {
  turn.turns = terms.turns;
  if (!turn.turns) return;
  copy(w, turn.w);
  copy(arm, turn.arm);
  copy(R.transpose() * w, turn.w_A);
  for (int j = 0; j < 3; ++j) copy(R.col(j).cross(w), turn.r_w[j]);
  turn.speed2 = static_cast<float>(speed * speed);
  turn.speed = rounded_up(speed);
  // Half an ulp of float more than what the rounding to nearest may lose.
  turn.lift = rounded_up(terms.lift);
  turn.bow = static_cast<float>(terms.bow) * (1.0F - 1.2e-7F);
}

// A group that is moved as one: nothing changes between its parts.
bool moves_as_one(const Motion& a, const Motion& b) {
  return a.moves() && a.kind == b.kind && (a.v_W.array() == b.v_W.array()).all() &&
         (a.w_W.array() == b.w_W.array()).all() &&
         (a.w_W.isZero(0.0) || (a.axis_W.array() == b.axis_W.array()).all());
}

}  // namespace

BodyPath::BodyPath(const Motion& motion, const Vec3& origin, const Vec3& from_reference)
    : R0_(motion.X_W0.rotation()), origin0_(origin) {
  if (!motion.moves()) return;
  v_ = motion.v_W;
  speed_ = motion.w_W.norm();
  if (speed_ == 0.0) return;
  w_ = motion.w_W;
  const Vec3 axis = w_ / speed_;
  const Vec3 r = motion.kind == PathKind::kScrew
                     ? Vec3(motion.X_W0 * motion.reference_P - motion.axis_W + from_reference)
                     : from_reference;
  for (int c = 0; c < 3; ++c) {
    KR0_.col(c) = axis.cross(R0_.col(c));
    KKR0_.col(c) = axis.cross(KR0_.col(c));
  }
  side_ = axis.cross(r);
  inward_ = axis.cross(side_);
}

// R(t) = (1 + sin K + (1 - cos) K^2) R0 (Rodrigues).
void BodyPath::at(double t, Mat3& R, Vec3& origin, Vec3& arm) const {
  origin = origin0_ + t * v_;
  if (speed_ == 0.0) {
    R = R0_;
    arm.setZero();
    return;
  }
  const double half = 0.5 * speed_ * t;
  const double sine = std::sin(half), cosine = std::cos(half);
  const double s = 2.0 * sine * cosine, c = 2.0 * sine * sine;
  R = R0_ + s * KR0_ + c * KKR0_;
  const Vec3 turned = s * side_ + c * inward_;
  origin += turned;
  arm = turned - inward_;
}

PairMotion::PairMotion(const Solid& a, const Motion& motion_a, const Solid& b,
                       const Motion& motion_b)
    : solid_b_(b), world_b_(motion_b), radius_a_(a.bvh().radius_mm), radius_b_(b.bvh().radius_mm) {
  const Vec3& origin_a = a.bvh().origin;
  const Vec3& origin_b = b.bvh().origin;
  const auto size = [](const Motion& motion) {
    return std::max(motion.X_W0.p.norm(), motion.X_W1.p.norm());
  };
  const double extent = a.bvh().extent_mm + b.bvh().extent_mm + size(motion_a) + size(motion_b);
  rounding_mm_ = kRoundingFactor * kUnitRoundoff * extent;
  // Less than rounding is no motion.
  const auto travel = [&](const Motion& motion, double radius, const Vec3& origin_P) {
    const double mm =
        motion.travel_upper_bound_mm(radius + (origin_P - motion.reference_P).norm(), 0.0, 1.0);
    return mm > kUnitRoundoff * extent ? mm : 0.0;
  };
  double travel_a = travel(motion_a, radius_a_, origin_a);
  double travel_b = travel(motion_b, radius_b_, origin_b);
  if (moves_as_one(motion_a, motion_b)) travel_a = travel_b = 0.0;
  b_still_ = travel_b == 0.0;
  // The translations are subtracted first: far from the world's origin nothing else is lost.
  if (b_still_) {
    const Pose X_BW0 = motion_b.X_W0.inverse();
    Motion seen = travel_a > 0.0 ? motion_a : still_motion(motion_a.X_W0);
    seen.v_W = X_BW0.q * seen.v_W;
    seen.w_W = X_BW0.q * seen.w_W;
    seen.axis_W = X_BW0 * seen.axis_W;
    seen.X_W0 = X_BW0 * seen.X_W0;
    path_a_ = BodyPath(seen, seen.X_W0 * origin_a - origin_b,
                       seen.X_W0.q * (origin_a - seen.reference_P));
  } else {
    const auto path = [&](const Motion& motion, double mm, const Vec3& origin, const Vec3& base) {
      const Motion moving = mm > 0.0 ? motion : still_motion(motion.X_W0);
      return BodyPath(moving, base + moving.X_W0.q * origin,
                      moving.X_W0.q * (origin - moving.reference_P));
    };
    path_a_ = path(motion_a, travel_a, origin_a, motion_a.X_W0.p - motion_b.X_W0.p);
    path_b_ = path(motion_b, travel_b, origin_b, Vec3::Zero());
  }
  travel_mm_ = travel_a + travel_b;
  speed_rounding_mm_ =
      kRoundingFactor * kUnitRoundoff * (travel_mm_ + extent * (path_a_.speed() + path_b_.speed()));
}

const PairState& PairMotion::at(double t) {
  if (state_.t == t) return state_;
  state_.t = t;
  state_.a.v = path_a_.v();
  state_.a.w = path_a_.w();
  path_a_.at(t, state_.R, state_.p, state_.a.arm);
  if (b_still_) return state_;
  Mat3 R_WB;
  Vec3 origin_b;
  path_b_.at(t, R_WB, origin_b, state_.b.arm);
  const Mat3 R_BW = R_WB.transpose();
  state_.R = R_BW * state_.R;
  state_.p = R_BW * (state_.p - origin_b);
  state_.b.v = R_BW * path_b_.v();
  state_.b.w = R_BW * path_b_.w();
  state_.b.arm = R_BW * state_.b.arm;
  state_.a.v = R_BW * state_.a.v;
  state_.a.w = R_BW * state_.a.w;
  state_.a.arm = R_BW * state_.a.arm;
  return state_;
}

// The rest of the tick needs no horizon where neither body turns farther in it.
double PairMotion::horizon() const {
  const double speed = turning();
  return speed * (1.0 - state_.t) <= kHorizon_rad ? std::numeric_limits<double>::infinity()
                                                  : kHorizon_rad / speed;
}

void PairMotion::set_bounds(TurnTerms& terms, double speed, double horizon) const {
  const double ticks = std::min(horizon, 1.0 - state_.t), phi = speed * ticks;
  terms.turns = speed > 0.0;
  terms.bow = 1.0 - phi * phi / 12.0;
  terms.lift = speed * speed * ticks / 3.0;
}

const BoxFrame& PairMotion::frame(double target_mm) {
  return frame(target_mm, {nullptr, Vec3::Zero(), radius_a_}, {nullptr, Vec3::Zero(), radius_b_});
}

const BoxFrame& PairMotion::frame(double target_mm, const BoxAxes& boxes_a,
                                  const BoxAxes& boxes_b) {
  BoxFrame& f = frame_;
  const bool of_parts = boxes_a.axes == nullptr && boxes_b.axes == nullptr;
  if (of_parts && frame_t_ == state_.t && frame_target_ == target_mm) return f;
  frame_t_ = of_parts ? state_.t : -1.0;
  frame_target_ = target_mm;
  const SeenFromBoxes s(state_, boxes_a, boxes_b);
  set_axes(f, s.R);
  copy(s.p, f.p);
  copy(s.v, f.v);
  copy(s.R.transpose() * s.v, f.v_A);
  const double ends = horizon();
  f.rest = rounded_up(1.0 - state_.t);
  f.horizon = static_cast<float>(ends);
  const double speed_a = path_a_.speed(), speed_b = path_b_.speed();
  TurnTerms terms_a, terms_b;
  set_bounds(terms_a, speed_a, ends);
  set_bounds(terms_b, speed_b, ends);
  set_turn(f.a, terms_a, s.R, s.w_a, s.arm_a, speed_a);
  set_turn(f.b, terms_b, s.R, s.w_b, s.arm_b, speed_b);
  const double extent = boxes_a.radius_mm + boxes_b.radius_mm + s.p.norm();
  f.gap_allowance = rounded_up(std::max(target_mm, 0.0) + rounding_mm_ + kFloatRounding * extent);
  const double wide_a = speed_a > 0.0 ? boxes_a.radius_mm + s.arm_a.norm() : 0.0;
  const double wide_b = speed_b > 0.0 ? boxes_b.radius_mm + s.arm_b.norm() : 0.0;
  f.speed_allowance = rounded_up(
      speed_rounding_mm_ + kFloatRounding * (s.v.norm() + speed_a * wide_a + speed_b * wide_b));
  f.bend_allowance =
      rounded_up(kFloatRounding * (speed_a * speed_a * wide_a + speed_b * speed_b * wide_b));
  return f;
}

const BoxFrame& PairMotion::still_frame(const BoxAxes& boxes_a, const BoxAxes& boxes_b) {
  BoxFrame& f = still_frame_;
  Mat3 R = state_.R;
  Vec3 p = state_.p - boxes_b.from_origin;
  if (boxes_a.axes != nullptr) {
    p += R * boxes_a.from_origin;
    R = R * boxes_a.axes->transpose();
  }
  if (boxes_b.axes != nullptr) {
    p = *boxes_b.axes * p;
    R = *boxes_b.axes * R;
  }
  set_axes(f, R);
  copy(p, f.p);
  f.gap_allowance = rounded_up(rounding_mm_ +
                               kFloatRounding * (boxes_a.radius_mm + boxes_b.radius_mm + p.norm()));
  return f;
}

const LeafFrame& PairMotion::leaf_frame(double taken_mm, double suspect_mm) {
  leaf_.taken_mm = taken_mm + rounding_mm_;
  leaf_.suspect_mm = suspect_mm + 2.0 * rounding_mm_;
  if (leaf_t_ == state_.t) return leaf_;
  leaf_t_ = state_.t;
  const PairState& s = state_;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) leaf_.r[i][j] = s.R(i, j);
  copy(s.p, leaf_.p);
  const Vec3 v = s.a.v - s.b.v;
  copy(v, leaf_.v);
  leaf_.horizon = horizon();
  leaf_.speed_slack = speed_rounding_mm_;
  leaf_.bend_slack = 0.0;
  leaf_.sweep = 0.0;
  const auto set_terms = [&](TurnTerms& terms, const BodyState& body, double speed) {
    set_bounds(terms, speed, leaf_.horizon);
    copy(body.w, terms.w);
    copy(body.arm, terms.arm);
  };
  if (turns_a()) {
    set_terms(leaf_.a, s.a, path_a_.speed());
    leaf_.sweep = 2.0 * s.a.w.cross(v).norm();
  }
  if (turns_b()) set_terms(leaf_.b, s.b, path_b_.speed());
  // Whatever the place is wrong by, the acceleration is wrong by |w|^2 times as much.
  const auto bend_rounding = [](double speed, const Vec3& arm, double radius) {
    return kRoundingFactor * kUnitRoundoff * speed * speed * (arm.norm() + radius);
  };
  leaf_.bend_slack = bend_rounding(path_a_.speed(), s.a.arm, radius_a_ + radius_b_ + s.p.norm()) +
                     bend_rounding(path_b_.speed(), s.b.arm, radius_b_);
  return leaf_;
}

Vec3 PairMotion::to_world(const Vec3& x_local_b, double t) const {
  return world_b_.pose_at(t) * (x_local_b + solid_b_.bvh().origin);
}

}  // namespace mortise::ccd
