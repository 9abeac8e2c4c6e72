#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// The answer to a request about a constraint.
struct GuidanceReply {
  Refusal refusal = Refusal::kNone;
  std::string text;  ///< the reason of a refusal; else the freedom that the part keeps
  ConstraintId id;   ///< of the constraint that was added or dropped
  int freedom = 6;   ///< motions that the constraints of the part (its group) leave, 0..6
};

/// May the user set this constraint now? Changes nothing. Only the holder of the part may; the
/// other part may be held by anybody. Refused: unknown user, part or feature, not the holder, a
/// kind that cannot hold between these surfaces, and a contradiction to constraints in force. A
/// constraint that leaves no freedom is not refused; the reply says so.
GuidanceReply check_constraint(const World& world, UserId user, const Constraint& constraint);

/// Checks and sets. Ids count up, so that a replay of the same calls gives the same ones.
GuidanceReply add_constraint(World& world, UserId user, const Constraint& constraint);

/// Removes a constraint; only the holder of its part may.
GuidanceReply drop_constraint(World& world, UserId user, ConstraintId id);

/// Removes the constraints of a part that is released or changes its holder and returns them, by
/// id. Constraints of other parts to it stay.
std::vector<ConstraintId> drop_constraints_of(World& world, PartId part);

/// A part that was placed (undo, reset) stays there until it is pushed.
void rest_guides_of(World& world, PartId part);

/// Call after a tick: a guided part that reached its target follows its constraints from now on;
/// one that was held back waits to be pushed.
void settle_guides(World& world, std::span<const PartId> moved, std::span<const PartId> held_back);

/// The faces of a constraint in force are others from now on, or have another place in their parts.
/// False: it cannot hold between them; then nothing has changed.
bool resolve_again(const World& world, Guide& guide, const Constraint& constraint);

/// How far the part (its group) is off its constraints, and the freedom that they leave.
struct GuidedState {
  double residual_mm = 0.0;
  int freedom = 6;
};
GuidedState guided_state(const World& world, PartId part);

/// A feature of a part by name: of the scenario or the generator, else a recognized one ("bore_1").
/// Meshes up to kRecognizedOnDemand triangles are searched on demand; larger ones must be
/// recognized when the scene is loaded: at that size it holds up the tick for a fraction of a
/// second (tests/bench/FIGURES.md, "Recognition beside the import"). Null: no such feature.
const Feature* find_feature(const World& world, PartId part, const std::string& name);
/// Triangles; see find_feature().
inline constexpr std::size_t kRecognizedOnDemand = 20'000;
/// All that are recognized in a mesh; null: it is larger than that, and nobody has searched it.
const std::vector<Feature>* recognized_in(const World& world, const Solid& solid);

}  // namespace mortise
