#pragma once
#include <cmath>

#include "common/base/constants.h"
#include "common/math/types.h"

namespace mortise {

/// Rigid motion X_AB: p_A = X_AB * p_B. Unit quaternion and translation in mm. Neighbouring frame
/// letters must match: X_AC = X_AB * X_BC.
struct Pose {
  Quat q = Quat::Identity();
  Vec3 p = Vec3::Zero();

  static Pose translation(const Vec3& p_mm) { return {Quat::Identity(), p_mm}; }

  /// Inlined, which the product of Eigen is not, and the same bit for bit.
  Vec3 operator*(const Vec3& x) const {
    Vec3 turned = q.vec().cross(x);
    turned += turned;
    return x + q.w() * turned + q.vec().cross(turned) + p;
  }
  Pose operator*(const Pose& other) const { return {(q * other.q).normalized(), q * other.p + p}; }
  Pose inverse() const { return {q.conjugate(), -(q.conjugate() * p)}; }
  Mat3 rotation() const { return q.toRotationMatrix(); }
};

/// The same pose bit for bit.
inline bool identical(const Pose& a, const Pose& b) {
  return (a.q.coeffs().array() == b.q.coeffs().array()).all() && (a.p.array() == b.p.array()).all();
}

/// A usable rigid motion: finite, a unit quaternion, no coordinate beyond kLargestCoordinate_mm.
inline bool valid(const Pose& X) {
  // Quiet comparisons: NaN raises no floating-point exception.
  const auto within = [](double x) { return std::islessequal(std::abs(x), kLargestCoordinate_mm); };
  return std::islessequal(std::abs(X.q.coeffs().squaredNorm() - 1.0), 2.0 * kUnitSlack) &&
         within(X.p.x()) && within(X.p.y()) && within(X.p.z());
}

}  // namespace mortise
