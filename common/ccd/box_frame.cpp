#include <cmath>

#include "common/ccd/pair_motion.h"

// What the box kernels need, from what PairMotion knows.
namespace mortise::ccd {
namespace {

// Float arithmetic of one box test makes at most some forty errors of half an ulp, 6e-8 of the
// extent.
constexpr double kFloatRounding = 3e-6;

// Of a value that is not negative: at least x, at most three ulp more.
float rounded_up(double x) { return static_cast<float>(x) * (1.0F + 0x1p-22F); }

template <class Vector>
void copy(const Vector& from, float* to) {
  const Vec3 x = from;
  for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(x[c]);
}

}  // namespace

const BoxFrame& PairMotion::frame(double target_mm) {
  return frame(target_mm, {nullptr, Vec3::Zero(), radius_a_}, {nullptr, Vec3::Zero(), radius_b_});
}

const BoxFrame& PairMotion::frame(double target_mm, const BoxAxes& boxes_a,
                                  const BoxAxes& boxes_b) {
  BoxFrame& f = frame_;
  const PairState& s = state_;
  const bool of_parts = boxes_a.axes == nullptr && boxes_b.axes == nullptr;
  if (of_parts && frame_t_ == s.t && frame_target_ == target_mm) return f;
  frame_t_ = of_parts ? s.t : -1.0;
  frame_target_ = target_mm;
  // All in axes of the boxes of B, from their origin.
  const Vec3 from_origin_a = s.R * boxes_a.from_origin;
  Mat3 R = s.R;
  Vec3 p = s.p + from_origin_a - boxes_b.from_origin;
  Vec3 v = s.a.v - s.b.v, w_a = s.a.w, arm_a = s.a.arm + from_origin_a;
  Vec3 w_b = s.b.w, arm_b = s.b.arm + boxes_b.from_origin;
  if (boxes_a.axes != nullptr) R = R * boxes_a.axes->transpose();
  if (boxes_b.axes != nullptr) {
    const Mat3& N = *boxes_b.axes;
    R = N * R;
    p = N * p;
    v = N * v;
    w_a = N * w_a;
    arm_a = N * arm_a;
    w_b = N * w_b;
    arm_b = N * arm_b;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      f.r[i][j] = static_cast<float>(R(i, j));
      f.abs_r[i][j] = std::fabs(f.r[i][j]);
    }
  copy(p, f.p);
  copy(v, f.v);
  const double ends = horizon();
  f.rest = rounded_up(1.0 - s.t);
  f.horizon = static_cast<float>(ends);
  const auto set_turn = [&](BoxTurn& turn, const Vec3& w, const Vec3& arm, double speed) {
    turn.turns = speed > 0.0;
    if (!turn.turns) return;
    TurnTerms terms;
    set_bounds(terms, speed, ends);
    copy(w, turn.w);
    copy(arm, turn.arm);
    copy(R.transpose() * w, turn.w_A);
    for (int j = 0; j < 3; ++j) copy(R.col(j).cross(w), turn.r_w[j]);
    turn.speed2 = static_cast<float>(speed * speed);
    turn.speed = rounded_up(speed);
    // Half an ulp of float more than what the rounding to nearest may lose.
    turn.lift = rounded_up(terms.lift);
    turn.bow = static_cast<float>(terms.bow) * (1.0F - 1.2e-7F);
  };
  set_turn(f.a, w_a, arm_a, path_a_.speed());
  set_turn(f.b, w_b, arm_b, path_b_.speed());
  const double extent = boxes_a.radius_mm + boxes_b.radius_mm + p.norm();
  f.gap_allowance = rounded_up(std::max(target_mm, 0.0) + rounding_mm_ + kFloatRounding * extent);
  const double speed_a = path_a_.speed(), speed_b = path_b_.speed();
  const double wide_a = speed_a > 0.0 ? boxes_a.radius_mm + arm_a.norm() : 0.0;
  const double wide_b = speed_b > 0.0 ? boxes_b.radius_mm + arm_b.norm() : 0.0;
  f.speed_allowance = rounded_up(speed_rounding_mm_ +
                                 kFloatRounding * (v.norm() + speed_a * wide_a + speed_b * wide_b));
  f.bend_allowance =
      rounded_up(kFloatRounding * (speed_a * speed_a * wide_a + speed_b * speed_b * wide_b));
  copy(R.transpose() * v, f.v_A);
  return f;
}

}  // namespace mortise::ccd
