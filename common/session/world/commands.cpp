#include "common/session/world/commands.h"

#include <algorithm>

#include "common/session/guide/guidance.h"
#include "common/session/guide/snap_candidates.h"
#include "common/session/world/decisions.h"
#include "common/session/world/placing.h"
#include "common/session/world/review.h"
#include "common/session/world/rights.h"
#include "common/session/world/scene_edits.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

struct Refused {
  Refusal refusal = Refusal::kNone;
  std::string text;
};

Refused held_by_other(const World& world, const Part& part) {
  return {Refusal::kHeldByOther,
          "'" + part.name + "' is held by " + quoted_name(world, part.holder)};
}

// 1. what every command about a part needs

Refused check_part(const World& world, PartId id) {
  const Part* part = world.find_present(id);
  if (!part) return {Refusal::kUnknownPart, "there is no part " + std::to_string(id.value)};
  if (!part->moving)
    return {Refusal::kPartIsStatic, "'" + part->name + "' is static in this scenario"};
  return {};
}

Refused check_may_hold(const World& world, const User& user, const Part& part) {
  if (may_hold(world, user, part)) return {};
  return {Refusal::kNotAllowed,
          "the scenario does not let '" + user.name + "' hold '" + part.name + "'"};
}

// 2. holding

Refused check_grab(const World& world, const User& user, PartId id) {
  Refused refused = check_part(world, id);
  if (refused.refusal != Refusal::kNone) return refused;
  const Part& part = *world.find(id);
  refused = check_may_hold(world, user, part);
  if (refused.refusal == Refusal::kNone && part.holder && part.holder != user.id)
    return held_by_other(world, part);
  return refused;
}

Refused check_holds(const World& world, const User& user, PartId id) {
  Refused refused = check_part(world, id);
  if (refused.refusal != Refusal::kNone) return refused;
  const Part& part = *world.find(id);
  if (part.holder == user.id) return {};
  if (!part.holder) return {Refusal::kNotHolder, "nobody holds '" + part.name + "'"};
  refused = held_by_other(world, part);
  refused.refusal = Refusal::kNotHolder;
  return refused;
}

bool is_for_several(CommandKind kind) {
  return kind == CommandKind::kGrab || kind == CommandKind::kRelease || kind == CommandKind::kReset;
}

// All parts of a command pass the same check, or the first that does not speaks for all.
template <class Check>
Refused check_all(const Command& command, Check check) {
  const std::vector<PartId>& parts = command.details.parts;
  if (parts.empty()) return check(command.part);
  if (parts.size() > kMostGroupParts)
    return {Refusal::kBadGroup,
            "a group has at most " + std::to_string(kMostGroupParts) + " parts"};
  std::vector<PartId> sorted = parts;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    return {Refusal::kBadGroup,
            "part " + std::to_string(twice->value) + " stands in the group twice"};
  for (const PartId part : parts)
    if (Refused refused = check(part); refused.refusal != Refusal::kNone) {
      refused.text += "; none of the " + std::to_string(parts.size()) + " parts was touched";
      return refused;
    }
  return {};
}

// 3. taking back and repeating

Refused check_history(const World& world, const User& user, const Command& command) {
  const Part* known = world.find(command.part);
  if (known == nullptr) return check_part(world, command.part);
  const Part& part = *known;
  const bool undo = command.kind == CommandKind::kUndo;
  const auto form = undo ? part.history.form_of_undo() : part.history.form_of_redo(user.id);
  // An edit can be taken back of a part that stands, or is gone.
  if (!form)
    if (Refused refused = check_part(world, command.part); refused.refusal != Refusal::kNone)
      return refused;
  const MoveHistory::Answer answer =
      undo ? part.history.may_undo(user.id) : part.history.may_redo(user.id);
  if (answer.refusal == Refusal::kMovedBySomeoneElse)
    return {answer.refusal,
            "'" + part.name + "' was moved by " + quoted_name(world, answer.by) + " since"};
  if (answer.refusal != Refusal::kNone)
    return {answer.refusal,
            "there is no move of '" + part.name + "' to " + (undo ? "undo" : "redo")};
  if (part.holder && part.holder != user.id) return held_by_other(world, part);
  if (!form) return {};
  EditReply reply = check_form(world, user, part, *form);
  return {reply.refusal, std::move(reply.text)};
}

// 4. handing over

Refused check_ask(const World& world, const User& user, PartId id) {
  Refused refused = check_part(world, id);
  if (refused.refusal != Refusal::kNone) return refused;
  const Part& part = *world.find(id);
  refused = check_may_hold(world, user, part);
  if (refused.refusal != Refusal::kNone) return refused;
  if (!part.holder) return {Refusal::kNotHeld, "nobody holds '" + part.name + "': grab it"};
  if (part.holder == user.id)
    return {Refusal::kNotAllowed, "'" + user.name + "' holds '" + part.name + "' already"};
  if (part.asked_by && part.asked_by != user.id)
    return {Refusal::kAlreadyAsked, quoted_name(world, part.asked_by) + " has asked " +
                                        quoted_name(world, part.holder) + " for '" + part.name +
                                        "' already"};
  return {};
}

Refused check_answer(const World& world, const User& user, const Command& command) {
  const Refused refused = check_holds(world, user, command.part);
  if (refused.refusal != Refusal::kNone) return refused;
  const Part& part = *world.find(command.part);
  const UserId to = command.details.other_user;
  if (!part.asked_by) return {Refusal::kNotAsked, "nobody asks for '" + part.name + "' (any more)"};
  if (to && to != part.asked_by)
    return {Refusal::kNotAsked,
            "it is " + quoted_name(world, part.asked_by) + " who asks for '" + part.name + "'"};
  return {};
}

Refused check_withdraw(const World& world, const User& user, PartId id) {
  Refused refused = check_part(world, id);
  if (refused.refusal != Refusal::kNone) return refused;
  const Part& part = *world.find(id);
  if (part.asked_by == user.id) return {};
  return {Refusal::kNotAsked, "'" + user.name + "' does not ask for '" + part.name + "'"};
}

// 5. rules of the session

Refused check_right(const World& world, const User& user, Right right) {
  if (may_change(world, user, right)) return {};
  return {Refusal::kNoRight, "'" + user.name + "' may not change " + std::string(name_of(right)) +
                                 " in this scenario"};
}

Refused check_policy(const World& world, const User& user, const Command& command) {
  const Refused refused = check_right(world, user, Right::kPolicy);
  if (refused.refusal != Refusal::kNone) return refused;
  if (!policy_named(command.details.text))
    return {Refusal::kBadRule, "policy: '" + command.details.text + "' is not known; write " +
                                   std::string(kPolicyNames)};
  return {};
}

// Both parts of a pair, moving or not.
Refused check_pair(const World& world, const Command& command) {
  for (const PartId id : {command.part, command.details.other_part})
    if (!world.find_present(id))
      return {Refusal::kUnknownPart, "there is no part " + std::to_string(id.value)};
  if (command.part == command.details.other_part)
    return {Refusal::kBadRule, "a pair needs two parts"};
  return {};
}

Refused check_exclusion(const World& world, const User& user, const Command& command) {
  Refused refused = check_right(world, user, Right::kExclusions);
  if (refused.refusal == Refusal::kNone) refused = check_pair(world, command);
  if (refused.refusal != Refusal::kNone) return refused;
  const PairRule* rule = world.rule(command.part, command.details.other_part);
  const bool excluded = rule && rule->excluded;
  if (command.kind == CommandKind::kSetExclusion && command.details.text.empty())
    return {Refusal::kBadRule, "reason is missing: the report must say why the pair is left out"};
  if (command.kind == CommandKind::kDropExclusion && !excluded)
    return {Refusal::kBadRule, "'" + world.find(command.part)->name + "' and '" +
                                   world.find(command.details.other_part)->name +
                                   "' are not excluded"};
  return {};
}

Refused check_review(const World& world, const User& user, const Command& command) {
  const Refused refused = check_right(world, user, Right::kReview);
  if (refused.refusal != Refusal::kNone) return refused;
  const UserId assignee = command.details.other_user;
  if (assignee && !world.find(assignee))
    return {Refusal::kUnknownUser, "there is no user " + std::to_string(assignee.value)};
  if (find_open(world, command.details.clash)) return {};
  return {Refusal::kUnknownClash,
          "clash " + std::to_string(command.details.clash.value) + " is not open"};
}

Refused check_tolerance(const World& world, const User& user, const Command& command) {
  const Refused refused = check_right(world, user, Right::kTolerance);
  if (refused.refusal != Refusal::kNone) return refused;
  if (!world.rules)
    return {Refusal::kBadRule, "this session has no scenario whose tolerances could be changed"};
  if (command.details.other_part) return check_pair(world, command);
  if (!world.find_present(command.part))
    return {Refusal::kUnknownPart, "there is no part " + std::to_string(command.part.value)};
  return {};
}

Refused check(const World& world, const Command& command) {
  const User* user = world.find(command.user);
  if (!user || !user->present)
    return {Refusal::kUnknownUser,
            "user " + std::to_string(command.user.value) + " is not in the session: join first"};
  if (user->role == Role::kObserver)
    return {Refusal::kObserver, "'" + user->name + "' is an observer and looks only"};
  // What is not looked at below must not be carried out.
  if (!command.details.parts.empty() && !is_for_several(command.kind))
    return {Refusal::kBadGroup, "only grab, release and reset take several parts: name one"};
  switch (command.kind) {
    case CommandKind::kGrab:
    case CommandKind::kReset:
      return check_all(command, [&](PartId part) { return check_grab(world, *user, part); });
    case CommandKind::kRelease:
      return check_all(command, [&](PartId part) { return check_holds(world, *user, part); });
    case CommandKind::kUndo:
    case CommandKind::kRedo:
      return check_history(world, *user, command);
    case CommandKind::kAskHandOver:
      return check_ask(world, *user, command.part);
    case CommandKind::kConsent:
    case CommandKind::kDecline:
      return check_answer(world, *user, command);
    case CommandKind::kWithdraw:
      return check_withdraw(world, *user, command.part);
    case CommandKind::kSetPolicy:
      return check_policy(world, *user, command);
    case CommandKind::kSetTolerance:
      return check_tolerance(world, *user, command);
    case CommandKind::kSetExclusion:
    case CommandKind::kDropExclusion:
      return check_exclusion(world, *user, command);
    case CommandKind::kReview:
      return check_review(world, *user, command);
    case CommandKind::kSnap:
      return check_holds(world, *user, command.part);
    case CommandKind::kAddConstraint:
    case CommandKind::kDropConstraint:
      return {};  // checked where they are done
    case CommandKind::kAddPart:
    case CommandKind::kReplacePart:
    case CommandKind::kRemovePart:
    case CommandKind::kSetMoving: {
      EditReply reply = check_edit(world, *user, command);
      return {reply.refusal, std::move(reply.text)};
    }
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
    case CommandKind::kRedo:
      return Decision::Kind::kRedo;
    case CommandKind::kAskHandOver:
      return Decision::Kind::kAskHandOver;
    case CommandKind::kConsent:
      return Decision::Kind::kHandOver;
    case CommandKind::kDecline:
      return Decision::Kind::kDecline;
    case CommandKind::kWithdraw:
      return Decision::Kind::kAskEnd;
    case CommandKind::kSetPolicy:
      return Decision::Kind::kSetPolicy;
    case CommandKind::kSetTolerance:
      return Decision::Kind::kSetTolerance;
    case CommandKind::kSetExclusion:
      return Decision::Kind::kSetExclusion;
    case CommandKind::kDropExclusion:
      return Decision::Kind::kDropExclusion;
    case CommandKind::kReview:
      return Decision::Kind::kReview;
    case CommandKind::kAddConstraint:
    case CommandKind::kSnap:
      return Decision::Kind::kAddConstraint;
    case CommandKind::kDropConstraint:
      return Decision::Kind::kDropConstraint;
    case CommandKind::kAddPart:
      return Decision::Kind::kAddPart;
    case CommandKind::kReplacePart:
      return Decision::Kind::kReplacePart;
    case CommandKind::kRemovePart:
      return Decision::Kind::kRemovePart;
    case CommandKind::kSetMoving:
      return Decision::Kind::kSetMoving;
    case CommandKind::kUnknown:
      break;
  }
  return Decision::Kind::kUnknown;
}

// Kinds whose check is their doing; the others were checked and are applied. Says what was decided.
Refused carry_out(World& world, Decision& decision) {
  switch (decision.kind) {
    case Decision::Kind::kSetTolerance: {
      const Status restated = set_tolerance(world, decision);
      return restated ? Refused{} : Refused{Refusal::kBadRule, restated.error().text};
    }
    case Decision::Kind::kAddConstraint: {
      decision.details.constraint.held.part = decision.part;
      const GuidanceReply reply = add_constraint(world, decision.user, decision.details.constraint);
      decision.details.constraint_id = reply.id;
      return {reply.refusal, reply.text};
    }
    case Decision::Kind::kDropConstraint: {
      const GuidanceReply reply =
          drop_constraint(world, decision.user, decision.details.constraint_id);
      return {reply.refusal, reply.text};
    }
    default: {
      EditReply reply = complete_edit(world, decision);
      if (reply.refusal != Refusal::kNone) return {reply.refusal, std::move(reply.text)};
      apply_decision(world, decision);
      return {};
    }
  }
}

Decision decide(const World& world, const Command& command) {
  Decision decision;
  decision.kind = decision_of(command.kind);
  decision.user = command.user;
  decision.part = command.part;
  decision.details = command.details;
  const Part* part = world.find(command.part);
  if (decision.kind == Decision::Kind::kAskHandOver || decision.kind == Decision::Kind::kAskEnd)
    decision.details.other_user = part->holder;
  if (decision.kind == Decision::Kind::kHandOver || decision.kind == Decision::Kind::kDecline)
    decision.details.other_user = part->asked_by;
  return decision;
}

// What the server chooses takes the place of what was left open: from then on it is as if the user
// had named it.
Refused choose(const World& world, Decision& decision) {
  Constraint& constraint = decision.details.constraint;
  constraint.held.part = decision.part;
  SnapChoice choice = choose_snap(world, decision.user, constraint);
  constraint = std::move(choice.constraint);
  return {choice.refusal, std::move(choice.text)};
}

}  // namespace

Reply apply_command(World& world, const Command& command, Decision& decision) {
  decision = {};
  Reply reply{command.user, command.part, command.seq, Refusal::kNone, UserId{}, ""};
  Refused refused = check(world, command);
  if (refused.refusal == Refusal::kNone) {
    Decision decided = decide(world, command);
    std::string chosen;
    if (command.kind == CommandKind::kSnap) {
      refused = choose(world, decided);
      chosen = refused.text + "; ";
    }
    if (refused.refusal == Refusal::kNone) {
      refused = carry_out(world, decided);
      refused.text = chosen + refused.text;
    }
    if (refused.refusal == Refusal::kNone) decision = std::move(decided);
  }
  reply.refusal = refused.refusal;
  reply.text = std::move(refused.text);
  if (const Part* part = world.find(command.part)) reply.holder = part->holder;
  return reply;
}

}  // namespace mortise
