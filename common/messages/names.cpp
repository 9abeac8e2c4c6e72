#include "common/messages/names.h"

namespace mortise {

// One line a value.
// clang-format off

std::string_view name_of(CollisionClass value) {
  switch (value) {
    case CollisionClass::kNone: return "none";
    case CollisionClass::kFake: return "fake";
    case CollisionClass::kPotential: return "potential";
    case CollisionClass::kReal: return "real";
  }
  return "?";
}

std::string_view name_of(DeviationGrade value) {
  switch (value) {
    case DeviationGrade::kUnknown: return "unknown";
    case DeviationGrade::kPlanar: return "planar";
    case DeviationGrade::kDeclaredFeature: return "declared feature";
    case DeviationGrade::kRecognizedFeature: return "recognized feature";
    case DeviationGrade::kDeclaredChord: return "declared chord error";
    case DeviationGrade::kEstimated: return "estimated";
    case DeviationGrade::kNominal: return "nominal";
  }
  return "?";
}

std::string_view name_of(FaceShape value) {
  switch (value) {
    case FaceShape::kUnknown: return "unknown";
    case FaceShape::kPlanar: return "planar";
    case FaceShape::kConvex: return "convex";
    case FaceShape::kConcave: return "concave";
    case FaceShape::kSaddle: return "saddle";
    case FaceShape::kEdge: return "edge";
  }
  return "?";
}

std::string_view name_of(SurfaceKind value) {
  switch (value) {
    case SurfaceKind::kUnknown: return "unknown";
    case SurfaceKind::kPlane: return "plane";
    case SurfaceKind::kCylinder: return "cylinder";
    case SurfaceKind::kCone: return "cone";
    case SurfaceKind::kSphere: return "sphere";
    case SurfaceKind::kTorus: return "torus";
  }
  return "?";
}

std::string_view name_of(SeparationWay value) {
  switch (value) {
    case SeparationWay::kNone: return "none";
    case SeparationWay::kBack: return "back along the motion";
    case SeparationWay::kNormal: return "along the normal";
    case SeparationWay::kFitted: return "turned and shifted";
    case SeparationWay::kAxis: return "along the axis";
    case SeparationWay::kStraight: return "along a line";
  }
  return "?";
}

std::string_view name_of(SeparationPath value) {
  switch (value) {
    case SeparationPath::kUnknown: return "not asked";
    case SeparationPath::kFree: return "free";
    case SeparationPath::kDeeper: return "goes deeper";
    case SeparationPath::kBlocked: return "blocked";
  }
  return "?";
}

std::string_view name_of(Refusal value) {
  switch (value) {
    case Refusal::kNone: return "none";
    case Refusal::kUnknownUser: return "unknown user";
    case Refusal::kUnknownPart: return "unknown part";
    case Refusal::kPartIsStatic: return "part is static";
    case Refusal::kNotHolder: return "not the holder";
    case Refusal::kHeldByOther: return "held by another user";
    case Refusal::kNotAllowed: return "not allowed to hold this part";
    case Refusal::kNotFinite: return "not finite";
    case Refusal::kRotationTooLarge: return "rotation above pi";
    case Refusal::kJumpTooLarge: return "jump above the limit";
    case Refusal::kDuplicate: return "duplicate sequence";
    case Refusal::kStale: return "stale sequence";
    case Refusal::kNothingToUndo: return "nothing to undo";
    case Refusal::kMovedBySomeoneElse: return "moved by someone else since";
    case Refusal::kRateTooHigh: return "rate above the limit";
    case Refusal::kSessionFull: return "session is full";
    case Refusal::kUnknownFeature: return "unknown feature";
    case Refusal::kConstraintUnfit: return "constraint does not fit these surfaces";
    case Refusal::kConstraintConflict: return "constraint contradicts another";
    case Refusal::kUnknownConstraint: return "unknown constraint";
    case Refusal::kObserver: return "observers look only";
    case Refusal::kNothingToRedo: return "nothing to redo";
    case Refusal::kNoRight: return "not allowed to change this";
    case Refusal::kNotHeld: return "nobody holds the part";
    case Refusal::kNotAsked: return "nobody asked for the part";
    case Refusal::kAlreadyAsked: return "asked for by another user";
    case Refusal::kBadRule: return "not a rule that can hold";
    case Refusal::kUnknownClash: return "unknown clash";
    case Refusal::kBadGroup: return "no group of parts";
    case Refusal::kNothingNear: return "nothing near to snap to";
    case Refusal::kUnknownMesh: return "unknown mesh";
    case Refusal::kUploadLimit: return "upload limit reached";
    case Refusal::kUnreadableMesh: return "mesh cannot be read";
    case Refusal::kBadPart: return "no part that could be added";
    case Refusal::kTooManyParts: return "too many parts";
  }
  return "?";
}

std::string_view name_of(ConstraintKind value) {
  switch (value) {
    case ConstraintKind::kUnknown: return "unknown";
    case ConstraintKind::kCoaxial: return "coaxial";
    case ConstraintKind::kCoplanar: return "coplanar";
    case ConstraintKind::kParallelDistance: return "parallel at a distance";
    case ConstraintKind::kTangent: return "tangent";
  }
  return "?";
}

std::string_view name_of(CommandKind value) {
  switch (value) {
    case CommandKind::kUnknown: return "unknown";
    case CommandKind::kGrab: return "grab";
    case CommandKind::kRelease: return "release";
    case CommandKind::kUndo: return "undo";
    case CommandKind::kReset: return "reset";
    case CommandKind::kRedo: return "redo";
    case CommandKind::kAskHandOver: return "ask for hand-over";
    case CommandKind::kConsent: return "consent";
    case CommandKind::kDecline: return "decline";
    case CommandKind::kSetPolicy: return "set policy";
    case CommandKind::kSetTolerance: return "set tolerance";
    case CommandKind::kSetExclusion: return "set exclusion";
    case CommandKind::kDropExclusion: return "drop exclusion";
    case CommandKind::kReview: return "review";
    case CommandKind::kAddConstraint: return "add constraint";
    case CommandKind::kDropConstraint: return "drop constraint";
    case CommandKind::kSnap: return "snap";
    case CommandKind::kWithdraw: return "withdraw";
    case CommandKind::kAddPart: return "add part";
    case CommandKind::kReplacePart: return "replace part";
    case CommandKind::kRemovePart: return "remove part";
    case CommandKind::kSetMoving: return "set moving";
  }
  return "?";
}

std::string_view name_of(Decision::Kind value) {
  switch (value) {
    case Decision::Kind::kUnknown: return "unknown";
    case Decision::Kind::kJoin: return "join";
    case Decision::Kind::kLeave: return "leave";
    case Decision::Kind::kGrab: return "grab";
    case Decision::Kind::kRelease: return "release";
    case Decision::Kind::kLeaseEnd: return "lease end";
    case Decision::Kind::kLivelinessLost: return "liveliness lost";
    case Decision::Kind::kUndo: return "undo";
    case Decision::Kind::kReset: return "reset";
    case Decision::Kind::kRedo: return "redo";
    case Decision::Kind::kAskHandOver: return "ask for hand-over";
    case Decision::Kind::kHandOver: return "hand-over";
    case Decision::Kind::kDecline: return "decline";
    case Decision::Kind::kAskEnd: return "ask withdrawn";
    case Decision::Kind::kSetPolicy: return "set policy";
    case Decision::Kind::kSetTolerance: return "set tolerance";
    case Decision::Kind::kSetExclusion: return "set exclusion";
    case Decision::Kind::kDropExclusion: return "drop exclusion";
    case Decision::Kind::kReview: return "review";
    case Decision::Kind::kAddConstraint: return "add constraint";
    case Decision::Kind::kDropConstraint: return "drop constraint";
    case Decision::Kind::kAddPart: return "add part";
    case Decision::Kind::kReplacePart: return "replace part";
    case Decision::Kind::kRemovePart: return "remove part";
    case Decision::Kind::kSetMoving: return "set moving";
  }
  return "?";
}

std::string_view name_of(ClashEvent::Kind value) {
  switch (value) {
    case ClashEvent::Kind::kUnknown: return "unknown";
    case ClashEvent::Kind::kBegin: return "begin";
    case ClashEvent::Kind::kChange: return "change";
    case ClashEvent::Kind::kEnd: return "end";
    case ClashEvent::Kind::kReview: return "review";
  }
  return "?";
}

std::string_view name_of(ReviewStatus value) {
  switch (value) {
    case ReviewStatus::kNew: return "new";
    case ReviewStatus::kActive: return "active";
    case ReviewStatus::kReviewed: return "reviewed";
    case ReviewStatus::kApproved: return "approved";
    case ReviewStatus::kResolved: return "resolved";
  }
  return "?";
}

std::string_view name_of(Unexamined value) {
  switch (value) {
    case Unexamined::kUnknown: return "unknown";
    case Unexamined::kWaitsForContact: return "waits for first contact";
    case Unexamined::kWaitsForDepth: return "waits for depth";
    case Unexamined::kGivenUp: return "given up";
    case Unexamined::kNoInside: return "no inside";
  }
  return "?";
}

std::string_view in_words(Unexamined value) {
  switch (value) {
    case Unexamined::kWaitsForContact:
      return "waits for its turn to be searched for contact";
    case Unexamined::kWaitsForDepth:
      return "waits for its turn, until its depth is worked out";
    case Unexamined::kGivenUp:
      return "was given up at the most work that one pair may have";
    case Unexamined::kNoInside:
      return "has an open mesh, so that what lies inside of it is not known";
    case Unexamined::kUnknown:
      break;
  }
  return "has no verdict";
}

std::string_view name_of(Role value) {
  switch (value) {
    case Role::kUnknown: return "unknown";
    case Role::kDesigner: return "designer";
    case Role::kObserver: return "observer";
    case Role::kBot: return "bot";
  }
  return "?";
}

// clang-format on
std::optional<Role> role_named(std::string_view name) {
  for (const Role role : {Role::kDesigner, Role::kObserver, Role::kBot})
    if (name_of(role) == name) return role;
  return std::nullopt;
}

}  // namespace mortise
