#include "common/session/guide/guidance.h"

#include <algorithm>
#include <cstdio>

#include "common/base/constants.h"
#include "common/geometry/recognition/recognized.h"
#include "common/messages/names.h"
#include "common/session/world/moving_group.h"

namespace mortise {
namespace {

GuidanceReply refuse(Refusal refusal, std::string text) {
  return {refusal, std::move(text), {}, 6};
}

std::string names_of(const Part& part) {
  constexpr std::size_t kShown = 8;  // names that a sentence bears
  if (part.features.empty()) return "it has none";
  std::string names = "it has ";
  for (std::size_t i = 0; i < std::min(kShown, part.features.size()); ++i)
    names += (i == 0 ? "" : ", ") + part.features[i].name;
  if (part.features.size() > kShown)
    names += " and " + std::to_string(part.features.size() - kShown) + " more";
  return names;
}

GuidedDisplacement as_it_stands(const World& world, const MovingGroup& group,
                                const Relation* added) {
  std::vector<Relation> relations = relations_of(world, group);
  if (added) relations.push_back(*added);
  return guided({relations, group.reference_W, group.lever_mm(), {}});
}

// The relation in the frames of the parts, with the nearer of both directions; or why there is
// none.
struct Resolved {
  GuidanceReply reply;
  Relation relation;
};

Resolved resolve(const World& world, const Constraint& constraint) {
  Resolved resolved;
  const Feature* features[2] = {};
  const FeatureOf* sides[2] = {&constraint.held, &constraint.other};
  for (int i = 0; i < 2; ++i) {
    const Part& part = *world.find(sides[i]->part);
    features[i] = find_feature(world, part.id, sides[i]->feature);
    if (features[i]) continue;
    resolved.reply =
        refuse(Refusal::kUnknownFeature,
               "'" + part.name + "' has no feature '" + sides[i]->feature + "': " + names_of(part));
    return resolved;
  }
  const Result<Relation> relation = relation_between(constraint.kind, features[0]->surface,
                                                     features[1]->surface, constraint.distance_mm);
  if (!relation) {
    resolved.reply = refuse(Refusal::kConstraintUnfit, relation.error().text);
    return resolved;
  }
  resolved.relation = *relation;
  const Vec3 a = world.find(constraint.held.part)->X_WP.q * relation->a.direction;
  const Vec3 b = world.find(constraint.other.part)->X_WP.q * relation->b.direction;
  resolved.relation.opposed = a.dot(b) < 0.0;
  return resolved;
}

std::string freedom_text(int freedom) {
  if (freedom == 0) return "no freedom is left: the part is held in place";
  return std::to_string(freedom) + " of 6 motions are left";
}

// Everything but the geometry.
GuidanceReply check_parts(const World& world, UserId user_id, const Constraint& constraint) {
  const User* user = world.find(user_id);
  if (!user || !user->present)
    return refuse(Refusal::kUnknownUser,
                  "user " + std::to_string(user_id.value) + " is not in the session: join first");
  for (const FeatureOf* side : {&constraint.held, &constraint.other})
    if (!world.find_present(side->part))
      return refuse(Refusal::kUnknownPart, "there is no part " + std::to_string(side->part.value));
  const Part& held = *world.find(constraint.held.part);
  if (held.holder != user_id)
    return refuse(Refusal::kNotHolder, "'" + held.name + "' is not held by '" + user->name +
                                           "': grab it before it is constrained");
  const Part& other = *world.find(constraint.other.part);
  if (held.id == other.id || (held.group && held.group == other.group))
    return refuse(Refusal::kConstraintUnfit, "'" + held.name + "' and '" + other.name +
                                                 "' move as one body: name a part "
                                                 "outside of it");
  const MovingGroup group = moving_group_of(world, held.id.value - 1);
  if (relations_of(world, group).size() >= kMostRelations)
    return refuse(Refusal::kConstraintConflict, "'" + held.name + "' has " +
                                                    std::to_string(kMostRelations) +
                                                    " constraints already: drop one first");
  return {};
}

Resolved check_all(const World& world, UserId user, const Constraint& constraint) {
  Resolved resolved;
  resolved.reply = check_parts(world, user, constraint);
  if (resolved.reply.refusal != Refusal::kNone) return resolved;
  resolved = resolve(world, constraint);
  if (resolved.reply.refusal != Refusal::kNone) return resolved;
  const MovingGroup group = moving_group_of(world, constraint.held.part.value - 1);
  Relation placed = resolved.relation;
  placed.a = moved(placed.a, world.find(constraint.held.part)->X_WP);
  placed.b = moved(placed.b, world.find(constraint.other.part)->X_WP);
  const GuidedDisplacement there = as_it_stands(world, group, &placed);
  const double extent_mm = group.reference_W.norm() + group.radius_mm + placed.b.point.norm();
  const double least_mm = std::max(kGuideAccuracy_mm, kRoundingFactor * kUnitRoundoff * extent_mm);
  if (there.residual_mm > least_mm) {
    char off[48];
    std::snprintf(off, sizeof off, "%.3g", there.residual_mm);
    resolved.reply = refuse(Refusal::kConstraintConflict,
                            std::string(name_of(constraint.kind)) +
                                " contradicts the constraints that hold: they cannot all be kept, "
                                "off by " +
                                off + " mm at best; drop one first");
    return resolved;
  }
  resolved.reply.freedom = there.freedom;
  resolved.reply.text = freedom_text(there.freedom);
  return resolved;
}

}  // namespace

const Feature* find_feature(const World& world, PartId part_id, const std::string& name) {
  const Part* part = world.find(part_id);
  if (!part) return nullptr;
  const auto among = [&](const std::vector<Feature>& features) -> const Feature* {
    const auto it = std::find_if(features.begin(), features.end(),
                                 [&](const Feature& feature) { return feature.name == name; });
    return it == features.end() ? nullptr : &*it;
  };
  if (const Feature* feature = among(part->features)) return feature;
  const std::vector<Feature>* shown = recognized_in(world, *part->solid);
  return shown != nullptr ? among(*shown) : nullptr;
}

const std::vector<Feature>* recognized_in(const World& world, const Solid& solid) {
  if (solid.mesh().triangles.size() > kRecognizedOnDemand) return nullptr;
  std::shared_ptr<const std::vector<Feature>>& known = world.recognized[solid.hash()];
  if (!known) {
    const auto shown = recognized(solid);
    known = {shown, &shown->features};
  }
  return known.get();
}

GuidanceReply check_constraint(const World& world, UserId user, const Constraint& constraint) {
  return check_all(world, user, constraint).reply;
}

GuidanceReply add_constraint(World& world, UserId user, const Constraint& constraint) {
  Resolved resolved = check_all(world, user, constraint);
  if (resolved.reply.refusal != Refusal::kNone) return resolved.reply;
  resolved.reply.id = ConstraintId{world.next_constraint++};
  world.guides.push_back({resolved.reply.id, user, constraint, resolved.relation, constraint.snap});
  return resolved.reply;
}

GuidanceReply drop_constraint(World& world, UserId user_id, ConstraintId id) {
  const User* user = world.find(user_id);
  if (!user || !user->present)
    return refuse(Refusal::kUnknownUser,
                  "user " + std::to_string(user_id.value) + " is not in the session: join first");
  const auto it = std::find_if(world.guides.begin(), world.guides.end(),
                               [&](const Guide& guide) { return guide.id == id; });
  if (it == world.guides.end())
    return refuse(Refusal::kUnknownConstraint,
                  "there is no constraint " + std::to_string(id.value));
  const PartId part = it->constraint.held.part;
  if (world.find(part)->holder != user_id)
    return refuse(Refusal::kNotHolder,
                  "'" + world.find(part)->name + "' is not held by '" + user->name + "'");
  world.guides.erase(it);
  GuidanceReply reply;
  reply.id = id;
  reply.freedom = guided_state(world, part).freedom;
  reply.text = freedom_text(reply.freedom);
  return reply;
}

bool resolve_again(const World& world, Guide& guide, const Constraint& constraint) {
  Resolved resolved = resolve(world, constraint);
  if (resolved.reply.refusal != Refusal::kNone) return false;
  resolved.relation.opposed = guide.relation.opposed;
  guide.constraint = constraint;
  guide.relation = resolved.relation;
  return true;
}

std::vector<ConstraintId> drop_constraints_of(World& world, PartId part) {
  std::vector<ConstraintId> dropped;
  for (const Guide& guide : world.guides)
    if (guide.constraint.held.part == part) dropped.push_back(guide.id);
  std::erase_if(world.guides, [&](const Guide& g) { return g.constraint.held.part == part; });
  return dropped;
}

void rest_guides_of(World& world, PartId part) {
  for (Guide& guide : world.guides)
    if (guide.constraint.held.part == part) guide.follows = false;
}

void settle_guides(World& world, std::span<const PartId> moved, std::span<const PartId> held_back) {
  for (Guide& guide : world.guides) {
    const PartId part = guide.constraint.held.part;
    const auto among = [&](std::span<const PartId> parts) {
      return std::find(parts.begin(), parts.end(), part) != parts.end();
    };
    if (among(held_back))
      guide.follows = false;
    else if (among(moved))
      guide.follows = true;
  }
}

GuidedState guided_state(const World& world, PartId part) {
  if (!world.find(part)) return {};
  const MovingGroup group = moving_group_of(world, part.value - 1);
  const std::vector<Relation> relations = relations_of(world, group);
  if (relations.empty()) return {};
  const double lever_mm = group.lever_mm();
  GuidedState state;
  state.freedom = guided({relations, group.reference_W, lever_mm, {}}).freedom;
  state.residual_mm = violation_mm({relations, group.reference_W, lever_mm, {}});
  return state;
}

}  // namespace mortise
