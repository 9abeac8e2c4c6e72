#include "common/session/world/decisions.h"

#include <algorithm>

#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/placing.h"
#include "common/session/world/review.h"
#include "common/session/world/scene_edits.h"
#include "common/session/world/standing.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

using Poses = std::vector<PartPose>;

// 1. who is there

// The id is somebody else's from now on.
void forget(World& world, UserId user) {
  for (Part& part : world.parts) part.history.forget(user);
  for (std::vector<Decision>* rules : {&world.standing, &world.restated})
    for (Decision& rule : *rules)
      if (rule.user == user) rule.user = UserId{};
  for (Remark& remark : world.remarks) {
    if (remark.user == user) remark.user = UserId{};
    if (remark.assignee == user) remark.assignee = UserId{};
  }
  if (world.state) forget_user(*world.state, user);
}

void join(World& world, const Decision& decision) {
  const Role role = decision.role == Role::kUnknown ? Role::kDesigner : decision.role;
  if (User* known = world.find(decision.user)) {
    if (takes_over_id(decision)) forget(world, known->id);
    known->present = true;
    known->last_seq = 0;  // whoever comes back may be a new program that counts from 1
    known->role = role;
    if (!decision.user_name.empty()) known->name = decision.user_name;
    return;
  }
  const UserId next{static_cast<std::uint32_t>(world.users.size() + 1)};
  if (decision.user && decision.user != next) return;
  world.users.push_back({next, decision.user_name, true, 0, role});
}

// Frees one part of the user, or all of them when no part is named.
Poses free_parts(World& world, UserId user, PartId only) {
  Poses freed;
  for (Part& part : world.parts) {
    if (!user || part.holder != user || (only && part.id != only)) continue;
    give(world, part, UserId{});
    freed.push_back(pose_of(part));
  }
  return freed;
}

Poses leave(World& world, UserId id) {
  if (User* user = world.find(id)) user->present = false;
  for (Part& part : world.parts)
    if (id && part.asked_by == id) part.asked_by = UserId{};
  return free_parts(world, id, PartId{});
}

// 2. parts, one or several

template <class Apply>
Poses for_parts(World& world, const Decision& decision, Apply apply) {
  std::vector<PartId> ids = decision.details.parts;
  if (ids.empty()) ids.push_back(decision.part);
  std::sort(ids.begin(), ids.end());
  Poses changed;
  for (const PartId id : ids)
    if (Part* part = world.find(id); part && apply(*part)) changed.push_back(pose_of(*part));
  return changed;
}

bool grab(World& world, Part& part, const Decision& decision) {
  if (!world.find(decision.user)) return false;
  // Grabbing again what one holds changes nothing, and keeps what can be undone.
  if (part.holder != decision.user) give(world, part, decision.user);
  return true;
}

// Parts that are grabbed together are moved together from then on.
Poses grab_all(World& world, const Decision& decision) {
  const Poses grabbed =
      for_parts(world, decision, [&](Part& part) { return grab(world, part, decision); });
  if (decision.details.parts.size() < 2) return grabbed;
  const GroupId group{world.next_group++};
  for (const PartPose& pose : grabbed) world.find(pose.part)->group = group;
  return grabbed;
}

bool release(World& world, Part& part, const Decision& decision) {
  if (!decision.user || part.holder != decision.user) return false;
  give(world, part, UserId{});
  return true;
}

bool undo(World& world, Part& part, const Decision& decision) {
  if (part.history.done.empty()) return false;
  const std::optional<PartForm> form = part.history.form_of_undo();
  const Pose X_WP = part.history.undo(part.X_WP, form_of(part));
  if (form)
    take_form(world, part, *form, decision);
  else
    put(world, part, X_WP, decision);
  return true;
}

bool redo(World& world, Part& part, const Decision& decision) {
  if (part.history.may_redo(decision.user).refusal != Refusal::kNone) return false;
  const std::optional<PartForm> form = part.history.form_of_redo(decision.user);
  const Pose X_WP = part.history.redo(decision.user);
  if (form)
    take_form(world, part, *form, decision);
  else
    put(world, part, X_WP, decision);
  return true;
}

bool reset(World& world, Part& part, const Decision& decision) {
  part.history.end_move();
  part.history.note(decision.user, part.X_WP);
  part.history.end_move();
  put(world, part, part.X_WP_scenario, decision);
  return true;
}

bool hand_over(World& world, Part& part, const Decision& decision) {
  const User* to = world.find(decision.details.other_user);
  if (!to || !to->present) return false;
  give(world, part, to->id);
  return true;
}

// 3. rules

// The last decision about a thing is the one that holds.
void stand(World& world, const Decision& decision) {
  std::erase_if(world.standing, [&](const Decision& old) { return same_target(old, decision); });
  world.standing.push_back(decision);
}

void set_policy(World& world, const Decision& decision) {
  const auto policy = policy_named(decision.details.text);
  if (!policy) return;
  world.policy = *policy;
  note_policy(world);
  stand(world, decision);
}

void set_exclusion(World& world, const Decision& decision, bool excluded) {
  const PartId other = decision.details.other_part;
  if (!world.find(decision.part) || !world.find(other) || decision.part == other) return;
  const auto key = std::minmax(decision.part, other);
  PairRule& rule = world.pair_rules[{key.first, key.second}];
  rule.a = key.first, rule.b = key.second;
  rule.excluded = excluded;
  rule.reason = excluded ? decision.details.text : "";
  note_surface(world, decision.part, other, decision);
  stand(world, decision);
}

}  // namespace

Status set_tolerance(World& world, const Decision& decision) {
  const PartId other = decision.details.other_part;
  if (!world.rules || !world.find(decision.part) || other == decision.part ||
      (other && !world.find(other)))
    return fail(Code::kInvalidInput, "there is no such part, or no scenario to change");
  const Details& details = decision.details;
  auto change = world.rules->restate(
      world, {decision.part, details.feature, details.other_part, details.other_feature},
      details.text);
  if (!change) return change.error();
  apply_change(world, decision, std::move(*change));
  stand(world, decision);
  if (!world.restated.empty() && same_target(world.restated.back(), decision))
    world.restated.pop_back();
  world.restated.push_back(decision);
  return ok();
}

std::vector<PartPose> apply_decision(World& world, const Decision& decision) {
  switch (decision.kind) {
    case Decision::Kind::kJoin:
      join(world, decision);
      return {};
    case Decision::Kind::kLeave:
    case Decision::Kind::kLivelinessLost:
      return leave(world, decision.user);
    case Decision::Kind::kLeaseEnd:
      return free_parts(world, decision.user, decision.part);
    case Decision::Kind::kRelease:
      return for_parts(world, decision, [&](Part& p) { return release(world, p, decision); });
    case Decision::Kind::kGrab:
      return grab_all(world, decision);
    case Decision::Kind::kUndo:
      return for_parts(world, decision, [&](Part& p) { return undo(world, p, decision); });
    case Decision::Kind::kRedo:
      return for_parts(world, decision, [&](Part& p) { return redo(world, p, decision); });
    case Decision::Kind::kReset:
      return for_parts(world, decision, [&](Part& p) { return reset(world, p, decision); });
    case Decision::Kind::kHandOver:
      return for_parts(world, decision, [&](Part& p) { return hand_over(world, p, decision); });
    case Decision::Kind::kAskHandOver:
      if (Part* part = world.find(decision.part)) part->asked_by = decision.user;
      return {};
    case Decision::Kind::kDecline:
    case Decision::Kind::kAskEnd:
      if (Part* part = world.find(decision.part)) part->asked_by = UserId{};
      return {};
    case Decision::Kind::kSetPolicy:
      set_policy(world, decision);
      return {};
    case Decision::Kind::kSetTolerance:
      // In a replay it was accepted before; where it cannot be now, nothing changes.
      (void)set_tolerance(world, decision);
      return {};
    case Decision::Kind::kSetExclusion:
    case Decision::Kind::kDropExclusion:
      set_exclusion(world, decision, decision.kind == Decision::Kind::kSetExclusion);
      return {};
    case Decision::Kind::kReview:
      review(world, decision);
      return {};
    case Decision::Kind::kAddConstraint:
      (void)add_constraint(world, decision.user, decision.details.constraint);
      return {};
    case Decision::Kind::kDropConstraint:
      (void)drop_constraint(world, decision.user, decision.details.constraint_id);
      return {};
    case Decision::Kind::kAddPart:
    case Decision::Kind::kReplacePart:
    case Decision::Kind::kRemovePart:
    case Decision::Kind::kSetMoving:
      (void)apply_edit(world, decision);
      return {};
    case Decision::Kind::kUnknown:
      break;
  }
  return {};
}

}  // namespace mortise
