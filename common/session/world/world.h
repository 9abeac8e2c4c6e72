#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/shared_vector.h"
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

/// One part of a session. Everything but pose, holder and history changes by decisions alone.
struct Part {
  PartId id;
  std::string name;
  SolidPtr solid;
  SurfaceBand band;                ///< resolved: deviation and tolerance of its faces
  SharedVector<Feature> features;  ///< checked against the mesh
  bool moving = false;
  bool present = true;      ///< false: it was removed; its number stays, and it may come back
  std::uint32_t edits = 0;  ///< edits of the running session: it came, went, begins to move ...
  Pose X_WP_scenario;       ///< where the scenario put it
  Pose X_WP;
  UserId holder;
  UserId asked_by;  ///< the user who waits for a hand-over of the part
  MoveHistory history;
  std::vector<std::string> notes;  ///< of the import of its mesh, for people
  GroupId group;  ///< parts of one group have one holder and move as one body; none: no group
  /// Parts of one kind were loaded with the same mesh, features and statements.
  std::uint32_t kind = 0;
};

/// The rule of a pair of parts: bands that replace the parts' bands, or an exclusion.
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

/// One constraint in force.
struct Guide {
  ConstraintId id;
  UserId user;  ///< who set it
  Constraint constraint;
  Relation relation;  ///< elements in the frames of the two parts
  /// The part moves to satisfy the constraint without being pushed: after a snap, and once it has
  /// satisfied it.
  bool follows = false;
};

class PartShapes;     ///< session/part_shapes.h
class SurfaceRules;   ///< session/surface_rules.h
struct SessionState;  ///< caches and open clashes between ticks, session/session_state.h

/// A session between two ticks: `step` reads it and, at its end, writes it. There is no clock or
/// socket here. After the first step poses and holders may change only by `step`, `apply_command`
/// and `apply_decision`, because caches depend on it. A copy shares `state` and must not be stepped
/// beside the original.
struct World {
  std::string name;
  double tick_rate_hz = 60.0;
  int threads = 1;  ///< ticks get work for so many, whatever number plays them; see work_budget.h
  Policy policy = Policy::kStop;
  double max_jump_mm = 50.0;
  double lease_s = 5.0;
  std::uint64_t tick = 0;
  std::vector<Part> parts;  ///< parts[i].id.value == i + 1
  std::vector<User> users;  ///< users[i].id.value == i + 1
  std::map<std::pair<PartId, PartId>, PairRule> pair_rules;
  /// Pairs whose clashes are approved by the scenario while neither part has moved, and why.
  std::map<std::pair<PartId, PartId>, std::string> approved_at_start;
  std::vector<Scenario::UserSpec> may_hold;  ///< who may hold and change what, see rights.h
  /// Fits and exclusions of the scenario, as decisions of nobody. They hold until a decision about
  /// the same takes their place.
  std::vector<Decision> declared;
  std::vector<Decision> standing;       ///< changes of policy, tolerance and exclusions in force
  std::vector<Remark> remarks;          ///< of clashes that are open, in order; see review.h
  std::shared_ptr<SurfaceRules> rules;  ///< null: tolerances cannot be changed
  std::shared_ptr<PartShapes> shapes;   ///< null: parts cannot be added
  std::uint64_t edits = 0;  ///< of the scene: whoever keeps lists of parts makes them anew
  /// Every accepted change of a tolerance and every added part, in order: applied to a fresh scene
  /// they give the present parts and bands. Of several consecutive changes of one target only the
  /// last is kept.
  std::vector<Decision> restated;
  std::vector<Guide> guides;  ///< by id, see session/guidance.h
  std::uint32_t next_constraint = 1, next_group = 1;
  /// Recognized features of meshes, by hash; filled when a constraint first names one. A cache.
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
  /// Null as well for a part that was removed.
  const Part* find_present(PartId id) const {
    const Part* part = find(id);
    return part != nullptr && part->present ? part : nullptr;
  }
  Part* find_present(PartId id) {
    Part* part = find(id);
    return part != nullptr && part->present ? part : nullptr;
  }
  const Part* find_part(const std::string& part_name) const;  ///< of those present
  const PairRule* rule(PartId a, PartId b) const;
};

/// The world as participants are told of it.
Snapshot snapshot_of(const World& world);

}  // namespace mortise
