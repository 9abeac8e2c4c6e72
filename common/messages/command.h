#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include <vector>

#include "common/base/ids.h"
#include "common/math/pose.h"
#include "common/messages/constraint.h"
#include "common/messages/review.h"
#include "common/messages/role.h"

namespace mortise {

/// What a user may request. Goes over the wire, so numbers never change. Beside `part`, a kind uses
/// the details that its comment names.
enum class CommandKind : std::uint8_t {
  kUnknown = 0,
  kGrab = 1,         ///< part, or parts: all of them or none
  kRelease = 2,      ///< part, or parts: all of them or none
  kUndo = 3,         ///< the user's own last move of the part
  kReset = 4,        ///< back to the pose of the scenario
  kRedo = 5,         ///< the move that was undone last
  kAskHandOver = 6,  ///< asks the holder of the part for it
  kConsent = 7,      ///< the holder gives it to the user who asked
  kDecline = 8,      ///< text: why, may be empty
  kSetPolicy = 9,    ///< text: stop, report
  kSetTolerance =
      10,  ///< feature, other_part, other_feature; text as in a scenario, empty: nothing
  kSetExclusion = 11,    ///< other_part; text: the reason
  kDropExclusion = 12,   ///< other_part
  kReview = 13,          ///< clash, status; other_user: whose task; text: the comment, may be empty
  kAddConstraint = 14,   ///< constraint; its held.part is `part`
  kDropConstraint = 15,  ///< constraint_id
  kSnap = 16,            ///< constraint: the server chooses the fields that are left empty
  kWithdraw = 17,        ///< takes back what the user asked of the holder of the part
  kAddPart = 18,         ///< edit: name, mesh, pose, moving; the server numbers the part
  kReplacePart = 19,     ///< edit: mesh; everything else of the part stays
  kRemovePart = 20,      ///< its number is never used again
  kSetMoving = 21,       ///< edit: moving
};
inline constexpr std::uint8_t kCommandKindCount = 22;

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
  kConstraintConflict = 18,  ///< it contradicts constraints in force
  kUnknownConstraint = 19,
  kObserver = 20,  ///< observers may not change anything
  kNothingToRedo = 21,
  kNoRight = 22,       ///< the scenario does not let this user change this
  kNotHeld = 23,       ///< nobody holds the part: grab it
  kNotAsked = 24,      ///< nobody asked for the part
  kAlreadyAsked = 25,  ///< another user has asked and waits for an answer
  kBadRule = 26,       ///< not understood, contradicts another statement, or changes nothing
  kUnknownClash = 27,
  kBadGroup = 28,        ///< a group of no parts, or with one twice
  kNothingNear = 29,     ///< no feature to snap to
  kUnknownMesh = 30,     ///< neither uploaded nor in the session
  kUploadLimit = 31,     ///< more bytes or uploads than a user may have
  kUnreadableMesh = 32,  ///< the file of an upload, or its bytes are not what was announced
  kBadPart = 33,         ///< a name that is taken or none, a pose beyond the limits, no change
  kTooManyParts = 34,
};
inline constexpr std::uint8_t kRefusalCount = 35;

/// What a scene edit says of its part.
struct PartEdit {
  std::string name;  ///< of an added part, as in a scenario
  /// Command: content_hash() of an uploaded file, or PartInfo::mesh_hash of any mesh of the
  /// session. Decision: PartInfo::mesh_hash.
  std::string mesh_hash;
  Pose X_WP;  ///< of an added part
  bool moving = false;
  /// Decision: how far a corner may be off for its file, mm; see ImportReport.
  double quantum_mm = 0.0;
  friend bool operator==(const PartEdit& x, const PartEdit& y) {
    return x.name == y.name && x.mesh_hash == y.mesh_hash && identical(x.X_WP, y.X_WP) &&
           x.moving == y.moving && x.quantum_mm == y.quantum_mm;
  }
};

/// What commands and decisions say beside user and part.
struct Details {
  std::vector<PartId> parts;           ///< of a group; `part` is then none
  PartId other_part;                   ///< the other one of a pair
  std::string feature, other_feature;  ///< of part and other_part; empty: the whole part
  UserId other_user;                   ///< to whom, from whom; of a review: whose task it is
  ClashId clash;
  ReviewStatus status = ReviewStatus::kNew;
  std::string text;
  Constraint constraint;
  ConstraintId constraint_id;  ///< of a decision also with kAddConstraint
  std::optional<PartEdit> edit = {};
  friend bool operator==(const Details&, const Details&) = default;
};

/// Most parts of one group: bounds the work of a tick and the length of a refusal.
inline constexpr std::size_t kMostGroupParts = 256;

struct Command {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;  ///< per user, echoed in the reply
  CommandKind kind = CommandKind::kUnknown;
  Details details = {};
  /// The user sent increments up to this sequence before the command, and not all of them are known
  /// to have arrived; 0: all have. A command that ends a drag waits for them.
  std::uint64_t after = 0;
};

struct Reply {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;
  Refusal refusal = Refusal::kNone;
  UserId holder;     ///< who holds the part now
  std::string text;  ///< the reason in words; when done mostly empty
};

/// A change of the session that the server decided outside of `step` and applied before it. Logged,
/// so that a replay can apply the same decisions, and told to everybody.
struct Decision {
  enum class Kind : std::uint8_t {
    kUnknown = 0,
    kJoin = 1,
    kLeave = 2,
    kGrab = 3,
    kRelease = 4,
    kLeaseEnd = 5,
    kLivelinessLost = 6,
    kUndo = 7,
    kReset = 8,
    kRedo = 9,
    kAskHandOver = 10,  ///< user asks details.other_user, who holds the part
    kHandOver = 11,     ///< user gives the part to details.other_user
    kDecline = 12,      ///< user keeps the part that details.other_user asked for
    kAskEnd = 13,       ///< user no longer asks for the part
    kSetPolicy = 14,
    kSetTolerance = 15,
    kSetExclusion = 16,
    kDropExclusion = 17,
    kReview = 18,
    kAddConstraint = 19,
    kDropConstraint = 20,
    kAddPart = 21,  ///< part: its number; details.edit, and in text what was found in its mesh
    kReplacePart = 22,
    kRemovePart = 23,
    kSetMoving = 24,
  };
  Kind kind = Kind::kUnknown;
  UserId user;
  PartId part;
  std::string user_name;       ///< with kJoin
  Role role = Role::kUnknown;  ///< with kJoin
  Details details = {};        ///< with kJoin: text is the former owner of the user id, see below
  friend bool operator==(const Decision&, const Decision&) = default;
};
inline constexpr std::uint8_t kDecisionKindCount = 25;

/// From this tick on an earlier decision is in force, or no longer is. See Snapshot::standing.
struct StandingChange {
  std::uint64_t tick = 0;
  bool holds = false;
  Decision decision;
};

/// Does it change which parts there are, what they are made of, or which of them move?
inline bool edits_scene(Decision::Kind kind) { return kind >= Decision::Kind::kAddPart; }

/// Does a user join with the id of another one who left long ago? Nothing of that user passes on.
inline bool takes_over_id(const Decision& decision) {
  return decision.kind == Decision::Kind::kJoin && !decision.details.text.empty();
}

}  // namespace mortise
