#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"
#include "common/messages/command.h"
#include "common/messages/constraint.h"
#include "common/messages/report.h"
#include "common/messages/scene.h"
#include "common/session/guide/relation.h"
#include "common/session/world/move_history.h"
#include "common/session/world/scenario.h"

namespace mortise {

/// One part of a session. Everything but pose, holder and history is fixed after load, but
/// for bands, which a decision may change.
struct Part {
  PartId id;
  std::string name;
  SolidPtr solid;
  SurfaceBand band;               ///< resolved: deviation and tolerance of its faces
  std::vector<Feature> features;  ///< checked against the mesh
  bool moving = false;
  Pose X_WP_scenario;  ///< where the scenario put it
  Pose X_WP;
  UserId holder;
  UserId asked_by;  ///< who waits for its holder to hand it over
  MoveHistory history;
  GroupId group;  ///< parts of one group have one holder and move as one body; none: by itself
};

/// What a pair of parts has of its own: bands that replace the parts' bands, or an exclusion.
struct PairRule {
  PartId a, b;                                        ///< a < b
  std::shared_ptr<const SurfaceBand> band_a, band_b;  ///< null: the part's own
  std::string fit;                                    ///< "Ø20 H7/g6"
  bool excluded = false;
  std::string reason;
};

struct User {
  UserId id;
  std::string name;
  bool present = false;
  std::uint64_t last_seq = 0;  ///< highest applied increment sequence
  Role role = Role::kDesigner;
};

/// One constraint that holds.
struct Guide {
  ConstraintId id;
  UserId user;  ///< who set it
  Constraint constraint;
  Relation relation;  ///< elements in the frames of the two parts
  /// The part goes for the constraint without being pushed: after a snap, and once it has kept it.
  bool follows = false;
};

class SurfaceRules;   ///< session/surface_rules.h
struct SessionState;  ///< caches and open clashes between ticks, session/session_state.h

/// A session between two ticks: what `step` reads and, at its end, writes. Nothing here knows a
/// clock or a socket. After the first step poses and holders change only by `step`,
/// `apply_command` and `apply_decision`: caches lean on it. A copy shares `state` and must not be
/// stepped beside the original.
struct World {
  std::string name;
  double tick_rate_hz = 60.0;
  Policy policy = Policy::kStop;
  double max_jump_mm = 50.0;
  double lease_s = 5.0;
  std::uint64_t tick = 0;
  std::vector<Part> parts;  ///< parts[i].id.value == i + 1
  std::vector<User> users;  ///< users[i].id.value == i + 1
  std::map<std::pair<PartId, PartId>, PairRule> pair_rules;
  std::vector<Scenario::UserSpec> may_hold;  ///< who may hold and change what, see rights.h
  std::vector<Decision> standing;  ///< changes of policy, tolerance and exclusions that hold now
  std::shared_ptr<SurfaceRules> rules;  ///< null: tolerances cannot be changed
  /// Every change of a tolerance that was accepted, in order: said again of a fresh scene they give
  /// the bands of now. Of several in a row about one thing the last.
  std::vector<Decision> restated;
  std::vector<Guide> guides;  ///< by id, see session/guidance.h
  std::uint32_t next_constraint = 1, next_group = 1;
  /// What meshes show, by hash; filled when a constraint first names such a feature. A cache.
  mutable std::map<std::string, std::shared_ptr<const std::vector<Feature>>> recognized;
  bool evaluates = false;  ///< some part has deviation or tolerance: near pairs are examined
  std::shared_ptr<SessionState> state;  ///< made by the first step

  Part* find(PartId id) { return id.value - 1 < parts.size() ? &parts[id.value - 1] : nullptr; }
  const Part* find(PartId id) const {
    return id.value - 1 < parts.size() ? &parts[id.value - 1] : nullptr;
  }
  User* find(UserId id) { return id.value - 1 < users.size() ? &users[id.value - 1] : nullptr; }
  const User* find(UserId id) const {
    return id.value - 1 < users.size() ? &users[id.value - 1] : nullptr;
  }
  const Part* find_part(const std::string& part_name) const;
  const PairRule* rule(PartId a, PartId b) const;
};

/// What the wire tells a participant of the world.
Snapshot snapshot_of(const World& world);

/// Checks and applies one request of a user. On success `decision` is what to log. What is refused
/// changes nothing, and says why in a sentence.
Reply apply_command(World& world, const Command& command, Decision& decision);

/// Applies a decision without asking: join, leave (frees the user's parts), lease end, and, in a
/// replay, all the others. A join without a user id takes the next one, which is then
/// users.back().id; with the id of an absent user it brings that user back, or, where
/// takes_over_id(), gives the id to somebody else, to whom nothing of that user belongs. Returns
/// the parts whose holder or pose changed, by id. What cannot apply (unknown user or part) changes
/// nothing.
std::vector<PartPose> apply_decision(World& world, const Decision& decision);

}  // namespace mortise
