#pragma once
#include <cstdint>
#include <limits>

#include "common/base/ids.h"
#include "common/math/interval.h"
#include "common/messages/command.h"
#include "common/messages/verdict.h"

namespace mortise {

/// A time that is not reached within the tick.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Begin, change, end or review of one clash. A clash is one pair of parts near one place, as long
/// as it lasts.
struct ClashEvent {
  enum class Kind : std::uint8_t { kUnknown = 0, kBegin = 1, kChange = 2, kEnd = 3, kReview = 4 };
  Kind kind = Kind::kUnknown;
  std::uint64_t seq = 0;  ///< per session, 1, 2, 3 ...: a gap means that events were lost
  std::uint64_t tick = 0;
  ClashId clash;
  PartId part_a, part_b;  ///< part_a < part_b
  UserId user;            ///< who moved a part of the pair last, or none; with a cause: who decided
  Verdict verdict;
  double t_contact = 1.0;       ///< time of first contact of the meshes inside the tick, 0..1
  double t_potential = kNever;  ///< 0..1: before it no admissible pair of real surfaces interferes
  double t_real = kNever;       ///< 0..1: first time at which every admissible pair interferes;
                                ///< both times are those of the pair of parts, and at the latest
                                ///< where a search met its cap
  std::uint64_t begin_tick = 0;
  CollisionClass worst_class = CollisionClass::kNone;
  Interval worst_delta_mm;
  /// The decision that put a part somewhere or changed a rule in this tick; kUnknown: a motion.
  Decision::Kind cause = Decision::Kind::kUnknown;
  Review review;               ///< after this event
  bool approval_lost = false;  ///< by this event: the clash got worse than what was approved
};

}  // namespace mortise
