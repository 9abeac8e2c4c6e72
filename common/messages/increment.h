#pragma once
#include <cstdint>

#include "common/base/constants.h"
#include "common/base/ids.h"
#include "common/math/types.h"
#include "common/messages/command.h"

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

/// What the numbers of an increment alone say: finite, at most half a turn, at most `longest_mm`
/// far. A length whose square overflows is infinite and too long.
inline Refusal refusal_of(const Increment& increment, double longest_mm) {
  if (!increment.translation_mm.allFinite() || !increment.rotation_rad.allFinite())
    return Refusal::kNotFinite;
  if (increment.rotation_rad.norm() > kMaxRotationPerTick_rad) return Refusal::kRotationTooLarge;
  if (increment.translation_mm.norm() > longest_mm) return Refusal::kJumpTooLarge;
  return Refusal::kNone;
}

}  // namespace mortise
