#include "common/session/world.h"

#include <algorithm>
#include <string_view>

#include "common/messages/names.h"
#include "common/session/guidance.h"
#include "common/session/session_state.h"

namespace mortise {
namespace {

// '*' stands for any run of characters, the empty one included.
bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, resume = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool may_hold(const World& world, const User& user, const Part& part) {
  if (world.may_hold.empty()) return true;
  for (const Scenario::UserSpec& spec : world.may_hold)
    if (matches(spec.name, user.name))
      for (const std::string& name : spec.may_hold)
        if (matches(name, part.name)) return true;
  return false;
}

std::string user_name(const World& world, UserId id) {
  const User* user = world.find(id);
  return user ? "'" + user->name + "'" : "user " + std::to_string(id.value);
}

PartPose pose_of(const Part& part) { return {part.id, part.holder, part.X_WP}; }

void put(World& world, Part& part, const Pose& X_WP) {
  part.X_WP = X_WP;
  rest_guides_of(world, part.id);
  note_placed(world, part.id.value - 1);
}

void give(World& world, Part& part, UserId holder) {
  part.holder = holder;
  part.group = {};
  part.moved_since_grab = false;
  drop_constraints_of(world, part.id);
  note_holder(world, part.id.value - 1);
}

void undo(World& world, Part& part) {
  const Pose back = *part.undo_X_WP;
  part.undo_X_WP.reset();
  part.moved_since_grab = false;  // the next move of the same grab can be undone in its turn
  put(world, part, back);
}

void reset(World& world, Part& part, UserId user) {
  part.undo_X_WP = part.X_WP;
  part.last_mover = user;
  part.moved_since_grab = false;
  put(world, part, part.X_WP_scenario);
}

struct Refused {
  Refusal refusal = Refusal::kNone;
  std::string text;
};

Refused held_by_other(const World& world, const Part& part) {
  return {Refusal::kHeldByOther, "'" + part.name + "' is held by " + user_name(world, part.holder)};
}

Refused check(const World& world, const Command& command) {
  const User* user = world.find(command.user);
  if (!user || !user->present)
    return {Refusal::kUnknownUser,
            "user " + std::to_string(command.user.value) + " is not in the session: join first"};
  const Part* part = world.find(command.part);
  if (!part)
    return {Refusal::kUnknownPart, "there is no part " + std::to_string(command.part.value)};
  if (!part->moving)
    return {Refusal::kPartIsStatic, "'" + part->name + "' is static in this scenario"};
  const bool other_holds = part->holder && part->holder != user->id;
  switch (command.kind) {
    case CommandKind::kGrab:
    case CommandKind::kReset:
      if (!may_hold(world, *user, *part))
        return {Refusal::kNotAllowed,
                "the scenario does not let '" + user->name + "' hold '" + part->name + "'"};
      if (other_holds) return held_by_other(world, *part);
      return {};
    case CommandKind::kRelease:
      if (other_holds) {
        Refused refused = held_by_other(world, *part);
        refused.refusal = Refusal::kNotHolder;
        return refused;
      }
      if (!part->holder) return {Refusal::kNotHolder, "nobody holds '" + part->name + "'"};
      return {};
    case CommandKind::kUndo:
      if (part->undo_X_WP && part->last_mover != user->id)
        return {Refusal::kMovedBySomeoneElse, "'" + part->name + "' was moved by " +
                                                  user_name(world, part->last_mover) + " since"};
      if (!part->undo_X_WP || part->last_mover != user->id)
        return {Refusal::kNothingToUndo, "there is no move of '" + part->name + "' to undo"};
      if (other_holds) return held_by_other(world, *part);
      return {};
    case CommandKind::kUnknown:
      break;
  }
  return {Refusal::kNotAllowed, "unknown command"};
}

Decision::Kind decision_of(CommandKind kind) {
  switch (kind) {
    case CommandKind::kGrab:
      return Decision::Kind::kGrab;
    case CommandKind::kRelease:
      return Decision::Kind::kRelease;
    case CommandKind::kUndo:
      return Decision::Kind::kUndo;
    case CommandKind::kReset:
      return Decision::Kind::kReset;
    case CommandKind::kUnknown:
      break;
  }
  return Decision::Kind::kUnknown;
}

void join(World& world, const Decision& decision) {
  if (User* known = world.find(decision.user)) {
    known->present = true;
    known->last_seq = 0;  // whoever comes back may be a new program that counts from 1
    if (!decision.user_name.empty()) known->name = decision.user_name;
    return;
  }
  const UserId next{static_cast<std::uint32_t>(world.users.size() + 1)};
  if (decision.user && decision.user != next) return;
  world.users.push_back({next, decision.user_name, true, 0});
}

// Frees one part of the user, or all of them when no part is named.
std::vector<PartPose> free_parts(World& world, UserId user, PartId only) {
  std::vector<PartPose> freed;
  for (Part& part : world.parts) {
    if (!user || part.holder != user || (only && part.id != only)) continue;
    give(world, part, UserId{});
    freed.push_back(pose_of(part));
  }
  return freed;
}

}  // namespace

const Part* World::find_part(const std::string& part_name) const {
  for (const Part& part : parts)
    if (part.name == part_name) return &part;
  return nullptr;
}

const PairRule* World::rule(PartId a, PartId b) const {
  if (pair_rules.empty()) return nullptr;
  const auto it = pair_rules.find(std::minmax(a, b));
  return it == pair_rules.end() ? nullptr : &it->second;
}

Snapshot snapshot_of(const World& world) {
  Snapshot snapshot;
  snapshot.session = world.name;
  snapshot.tick = world.tick;
  snapshot.tick_rate_hz = world.tick_rate_hz;
  snapshot.policy = name_of(world.policy);
  for (const Part& part : world.parts)
    snapshot.parts.push_back({part.id, part.name, part.solid->hash(), part.moving, part.holder,
                              part.X_WP, part.solid->sphere().center_mm,
                              part.solid->sphere().radius_mm});
  for (const User& user : world.users) snapshot.users.push_back({user.id, user.name, user.present});
  if (!world.state) return snapshot;
  snapshot.event_seq = world.state->event_seq;
  for (const auto& [pair, clashes] : world.state->open)
    for (const OpenClash& clash : clashes) snapshot.open_clashes.push_back(clash.last);
  std::sort(snapshot.open_clashes.begin(), snapshot.open_clashes.end(),
            [](const ClashEvent& x, const ClashEvent& y) { return x.clash < y.clash; });
  return snapshot;
}

Reply apply_command(World& world, const Command& command, Decision& decision) {
  decision = {};
  Reply reply{command.user, command.part, command.seq, Refusal::kNone, UserId{}, ""};
  Refused refused = check(world, command);
  if (refused.refusal == Refusal::kNone) {
    decision.kind = decision_of(command.kind);
    decision.user = command.user;
    decision.part = command.part;
    apply_decision(world, decision);
  }
  reply.refusal = refused.refusal;
  reply.text = std::move(refused.text);
  if (const Part* part = world.find(command.part)) reply.holder = part->holder;
  return reply;
}

std::vector<PartPose> apply_decision(World& world, const Decision& decision) {
  Part* part = world.find(decision.part);
  switch (decision.kind) {
    case Decision::Kind::kJoin:
      join(world, decision);
      return {};
    case Decision::Kind::kLeave:
    case Decision::Kind::kLivelinessLost:
      if (User* user = world.find(decision.user)) user->present = false;
      return free_parts(world, decision.user, PartId{});
    case Decision::Kind::kLeaseEnd:
      return free_parts(world, decision.user, decision.part);
    case Decision::Kind::kRelease:
      return part ? free_parts(world, decision.user, decision.part) : std::vector<PartPose>{};
    case Decision::Kind::kGrab:
      if (!part || !world.find(decision.user)) return {};
      // Grabbing again what one holds changes nothing, and keeps what can be undone.
      if (part->holder != decision.user) give(world, *part, decision.user);
      return {pose_of(*part)};
    case Decision::Kind::kUndo:
      if (!part || !part->undo_X_WP) return {};
      undo(world, *part);
      return {pose_of(*part)};
    case Decision::Kind::kReset:
      if (!part) return {};
      reset(world, *part, decision.user);
      return {pose_of(*part)};
    case Decision::Kind::kUnknown:
      break;
  }
  return {};
}

}  // namespace mortise
