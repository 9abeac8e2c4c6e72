#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"

namespace mortise {

enum class CommandKind : std::uint8_t { kUnknown = 0, kGrab, kRelease, kUndo, kReset };

/// Why something was not done. Goes over the wire and into the log, so numbers never change.
enum class Refusal : std::uint8_t {
  kNone = 0,
  kUnknownUser = 1,
  kUnknownPart = 2,
  kPartIsStatic = 3,
  kNotHolder = 4,    ///< someone else, or nobody, holds the part
  kHeldByOther = 5,  ///< grab of a held part
  kNotAllowed = 6,   ///< the scenario does not let this user hold this part
  kNotFinite = 7,
  kRotationTooLarge = 8,
  kJumpTooLarge = 9,
  kDuplicate = 10,  ///< sequence already seen
  kStale = 11,      ///< sequence older than one already applied
  kNothingToUndo = 12,
  kMovedBySomeoneElse = 13,
  kRateTooHigh = 14,
  kSessionFull = 15,
  kUnknownFeature = 16,
  kConstraintUnfit = 17,     ///< the kind cannot hold between these surfaces
  kConstraintConflict = 18,  ///< it contradicts those that hold already
  kUnknownConstraint = 19,
};
inline constexpr std::uint8_t kRefusalCount = 20;

struct Command {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;  ///< per user, echoed in the reply
  CommandKind kind = CommandKind::kUnknown;
};

struct Reply {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;
  Refusal refusal = Refusal::kNone;
  UserId holder;     ///< who holds the part now
  std::string text;  ///< reason in words; empty when done
};

/// A change of who holds what (or of a pose by undo/reset), decided by the server outside of `step`
/// and applied before it. Logged, so that a replay can apply the same decisions.
struct Decision {
  enum class Kind : std::uint8_t {
    kUnknown = 0,
    kJoin,
    kLeave,
    kGrab,
    kRelease,
    kLeaseEnd,
    kLivelinessLost,
    kUndo,
    kReset
  };
  Kind kind = Kind::kUnknown;
  UserId user;
  PartId part;
  std::string user_name;  ///< with kJoin
};

}  // namespace mortise
