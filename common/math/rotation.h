#pragma once
#include "common/math/types.h"

namespace mortise {

/// Quaternion of the rotation vector w_rad (axis times angle). Exact to rounding for every angle,
/// zero included.
Quat rotation_exp(const Vec3& w_rad);

/// Rotation vector of q, |w| <= pi. At exactly pi the axis has its first non-zero component
/// positive, so that a replay takes the same path. q must be normalized.
Vec3 rotation_log(const Quat& q);

}  // namespace mortise
