#pragma once
#include <cstdint>

#include "common/base/ids.h"
#include "common/math/types.h"

namespace mortise {

/// One manipulation increment of one user. Paper eq. (1): X_new = dT X_current, dT acting on the
/// left. OURS: the rotation turns about the part's reference point (centre of its bounding sphere),
/// so that
///   c_W' = c_W + translation_mm,   R' = exp(rotation_rad) R,
/// both written in world axes. Several increments of one tick are composed in the server's order of
/// arrival.
struct Increment {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;  ///< per user, rising; a gap is a loss, a repetition is dropped
  Vec3 translation_mm = Vec3::Zero();
  Vec3 rotation_rad = Vec3::Zero();  ///< rotation vector, |.| <= pi
};

}  // namespace mortise
