#pragma once
#include <cmath>

#include "common/math/types.h"

namespace mortise {

/// How far the square of a direction's length may be from one: some thousand roundings of a vector
/// that was normalized and turned; a plane 1 km away is off by less than a nanometre.
inline constexpr double kUnitDirectionSlack = 1e-12;

/// A direction that bounds may be measured along. No number is none.
inline bool is_unit(const Vec3& n) {
  return std::islessequal(std::abs(n.squaredNorm() - 1.0), kUnitDirectionSlack);
}

}  // namespace mortise
