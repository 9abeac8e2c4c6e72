#include "common/session/memory/known_distance.h"

#include <algorithm>

#include "common/base/constants.h"

namespace mortise {
namespace {

// Upper bound of the shift of any point of a body between two of its poses in one frame.
double shift_upper_bound_mm(const Pose& X0, const Pose& X1, const BoundingSphere& sphere,
                            double twice_half_sine) {
  return (X1 * sphere.center_mm - X0 * sphere.center_mm).norm() +
         twice_half_sine * sphere.radius_mm;
}

}  // namespace

double relative_travel_upper_bound_mm(const MovingPair& query) {
  const Motion& a = query.motion_a;
  const Motion& b = query.motion_b;
  if (a.w_W.isZero(0.0) && b.w_W.isZero(0.0)) return (a.v_W - b.v_W).norm();
  const auto travel_mm = [](const Motion& motion, const BoundingSphere& sphere) {
    const double arm_mm = (sphere.center_mm - motion.reference_P).norm() + sphere.radius_mm;
    return motion.travel_upper_bound_mm(arm_mm, 0.0, 1.0);
  };
  return travel_mm(a, query.a->sphere()) + travel_mm(b, query.b->sphere());
}

double apart_lower_bound_mm(const PairMemo& memo, const MovingPair& query) {
  if (memo.apart_mm < 0.0) return -1.0;
  const Pose X_BA = query.motion_b.X_W0.inverse() * query.motion_a.X_W0;
  // Chord of the turn between the two relative poses: a point at radius r shifts by at most
  // 2 sin(angle / 2) r.
  const double twice_half_sine = 2.0 * (X_BA.q * memo.X_BA.q.conjugate()).vec().norm();
  const double shift_mm =
      std::min(shift_upper_bound_mm(memo.X_BA, X_BA, query.a->sphere(), twice_half_sine),
               shift_upper_bound_mm(memo.X_BA.inverse(), X_BA.inverse(), query.b->sphere(),
                                    twice_half_sine));
  const auto extent = [](const Solid& solid) {
    return solid.sphere().center_mm.norm() + solid.sphere().radius_mm;
  };
  const double extent_mm = extent(*query.a) + extent(*query.b) + query.motion_a.X_W0.p.norm() +
                           query.motion_b.X_W0.p.norm();
  return memo.apart_mm - shift_mm - relative_travel_upper_bound_mm(query) -
         kRoundingFactor * kUnitRoundoff * extent_mm;
}

void remember_apart(PairMemo& memo, const Pose& X_WA, const Pose& X_WB, double apart_mm) {
  memo.X_BA = X_WB.inverse() * X_WA;
  memo.apart_mm = apart_mm;
}

}  // namespace mortise
