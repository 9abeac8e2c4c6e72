#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// What became of a request about a constraint.
struct GuidanceReply {
  Refusal refusal = Refusal::kNone;
  std::string text;  ///< the reason of a refusal; else which freedom the part keeps
  ConstraintId id;   ///< of the constraint that was added or dropped
  int freedom = 6;   ///< motions that the constraints of the part (its group) leave, 0..6
};

/// May the user set this constraint now? Changes nothing. Only the holder of the part may; the
/// other part may be anyone's. Refused: unknown user, part or feature, not the holder, a kind that
/// cannot hold between these surfaces, and what contradicts the constraints that hold already. No
/// freedom left is no refusal: it is said.
GuidanceReply check_constraint(const World& world, UserId user, const Constraint& constraint);

/// Checks and sets. Ids count up, so that a replay of the same calls gives the same ones.
GuidanceReply add_constraint(World& world, UserId user, const Constraint& constraint);

/// Takes a constraint back; only the holder of its part may.
GuidanceReply drop_constraint(World& world, UserId user, ConstraintId id);

/// A part that is released (or changes hands) loses the constraints that guided it; those of other
/// parts to it stay. Returns them, by id. Called where a holder changes.
std::vector<ConstraintId> drop_constraints_of(World& world, PartId part);

/// A part that was put somewhere (undo, reset) stays there until it is pushed.
void rest_guides_of(World& world, PartId part);

/// After a tick: a guided part that got where it went follows its constraints from now on; one that
/// was held back waits to be pushed.
void settle_guides(World& world, std::span<const PartId> moved, std::span<const PartId> held_back);

/// How far the part (its group) is off its constraints, and what they leave.
struct GuidedState {
  double residual_mm = 0.0;
  int freedom = 6;
};
GuidedState guided_state(const World& world, PartId part);

/// A feature of a part by name: those of the scenario and of generators; where there is none of
/// that name, what the mesh shows ("bore_1"), asked of meshes up to kRecognizedOnDemand triangles,
/// some 10 us each; larger ones have to be recognized at the load. Null: none.
const Feature* find_feature(const World& world, PartId part, const std::string& name);
inline constexpr std::size_t kRecognizedOnDemand = 20'000;

/// What a client may offer to snap to.
struct SnapLimits {
  double angle_rad = 0.26;     ///< between axes or normals, either sense
  double distance_mm = 20.0;   ///< between axes, planes, centres as they are
  double radius_share = 0.05;  ///< difference of two radii, of the larger
  std::size_t most = 16;
};
struct SnapCandidate {
  Constraint constraint;       ///< coaxial, or coplanar for planes; snap is set
  double distance_mm = 0.0;    ///< how far the part would move, at its feature
  double angle_rad = 0.0;      ///< and turn
  double radius_off_mm = 0.0;  ///< difference of the radii; 0 for planes
};

/// Features of like kind near those of the part, nearest first: a round outside with a round inside
/// of nearly the same radius, planes that face each other. Searched are the features of the load
/// and those of meshes that were looked at since (world.recognized). O(features of the part times
/// features of all others within reach).
std::vector<SnapCandidate> snap_candidates(const World& world, PartId part,
                                           const SnapLimits& limits);

/// What a wish to snap comes to.
struct SnapChoice {
  Refusal refusal = Refusal::kNone;
  std::string text;  ///< the reason of a refusal; else what was chosen, in words
  Constraint constraint;
};

/// The nearest candidate that the wish allows, that agrees with the constraints that hold, and that
/// takes some freedom away. Of the wish, whose held.part must be, everything else may be none or
/// empty: then any. With other.part named, however far and askew it stands; else within the limits
/// above. Changes nothing. Cost: the search, and a check of each candidate up to the chosen one.
SnapChoice choose_snap(const World& world, UserId user, const Constraint& wish);

}  // namespace mortise
