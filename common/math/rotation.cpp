#include "common/math/rotation.h"

#include <cmath>

namespace mortise {

Quat rotation_exp(const Vec3& w_rad) {
  const double half = 0.5 * w_rad.norm();
  // sin(h)/h is 1 - h^2/6 + ..., whose second term is below half an ulp for h < 1e-8.
  const double sinc = half < 1e-8 ? 1.0 : std::sin(half) / half;
  const Vec3 v = 0.5 * sinc * w_rad;
  return Quat(std::cos(half), v.x(), v.y(), v.z()).normalized();
}

Vec3 rotation_log(const Quat& q) {
  Quat r = q;
  const auto first_nonzero_is_negative = [](const Vec3& v) {
    for (int i = 0; i < 3; ++i)
      if (v[i] != 0.0) return v[i] < 0.0;
    return false;
  };
  if (r.w() < 0.0 || (r.w() == 0.0 && first_nonzero_is_negative(r.vec()))) r.coeffs() = -r.coeffs();
  const double sine = r.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return r.vec() * (2.0 * std::atan2(sine, r.w()) / sine);
}

}  // namespace mortise
