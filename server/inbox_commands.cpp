#include "common/session/world/commands.h"
#include "server/inbox.h"

#include <algorithm>
#include <utility>

#include "common/messages/names.h"

namespace mortise {
namespace {

// What ends a drag, or looks at where it led.
bool waits_for_increments(CommandKind kind) {
  switch (kind) {
    case CommandKind::kRelease:
    case CommandKind::kUndo:
    case CommandKind::kRedo:
    case CommandKind::kReset:
    case CommandKind::kConsent:
    case CommandKind::kAddConstraint:
    case CommandKind::kDropConstraint:
    case CommandKind::kSnap:
      return true;
    default:
      return false;
  }
}

// Do both touch a part in common? A group, and what names no part, may touch any.
bool touch_alike(const Command& x, const Command& y) {
  return x.user == y.user && (x.part == y.part || !x.part || !y.part);
}

}  // namespace

bool Inbox::is_behind(const std::vector<DeferredCommand>& waiting, const Command& command) {
  return std::any_of(waiting.begin(), waiting.end(), [&](const DeferredCommand& other) {
    return touch_alike(other.received.command, command);
  });
}

void Inbox::carry_out_deferred(World& world, std::int64_t now_ns, Intake& intake) {
  std::vector<DeferredCommand> still_waiting;
  for (DeferredCommand& d : std::exchange(deferred_, {})) {
    const Command& command = d.received.command;
    if (is_behind(still_waiting, command) || waits(d, now_ns)) {
      still_waiting.push_back(std::move(d));
    } else {
      carry_out(command, world, now_ns, intake);
    }
  }
  deferred_ = std::move(still_waiting);
  std::erase_if(goodbyes_, [&](const DeferredGoodbye& goodbye) {
    if (waits(goodbye.user, PartId{}, goodbye.after)) return false;
    leave(goodbye.user, true, world, intake);
    return true;
  });
}

void Inbox::admit_command(const ReceivedCommand& received, World& world, std::int64_t now_ns,
                          Intake& intake) {
  const Command& command = received.command;
  ++counters_.commands;
  Reply reply{command.user, command.part, command.seq, Refusal::kNone, {}, {}};
  if (const Part* part = world.find(command.part)) reply.holder = part->holder;
  Seat* seat = seat_of(command.user, received.client);
  if (seat == nullptr) {
    reply.user = first_user_of(received.client);
    reply.refusal = Refusal::kUnknownUser;
    reply.text = "the sender has not joined as this user";
  } else if (const Refusal order = seat->commands.admit(command.seq); order != Refusal::kNone) {
    reply.refusal = order;
    reply.text = std::string(name_of(order));
  } else if (!take_token(*seat, now_ns)) {
    reply.refusal = Refusal::kRateTooHigh;
    reply.text = "more messages a second than the session accepts from one user, or from all";
  }
  ++counters_of(reply.user).commands;
  if (reply.refusal != Refusal::kNone) {
    ++counters_.commands_refused;
    ++counters_of(reply.user).commands_refused;
    intake.replies.push_back(std::move(reply));
    return;
  }
  DeferredCommand deferred{received, seat->increments.newest(), now_ns};
  if (waits_for_increments(command.kind)) {
    deferred.after = std::max(deferred.after, command.after);
    deferred.until_ns = now_ns + static_cast<std::int64_t>(limits_.after_wait_s * 1e9);
  }
  if (is_behind(deferred_, command) ||
      (waits_for_increments(command.kind) && waits(deferred, now_ns))) {
    ++counters_.commands_deferred;
    deferred_.push_back(std::move(deferred));
  } else {
    carry_out(command, world, now_ns, intake);
  }
}

bool Inbox::waits(const DeferredCommand& deferred, std::int64_t now_ns) {
  const Command& command = deferred.received.command;
  if (waits(command.user, command.part, deferred.after)) return true;
  const Seat& seat = seats_[command.user.value - 1];
  if (!seat.present || seat.increments.newest() >= deferred.after) return false;
  if (now_ns < deferred.until_ns) return true;
  counters_.commands_overdue += waits_for_increments(command.kind);
  return false;
}

void Inbox::carry_out(const Command& command, World& world, std::int64_t now_ns, Intake& intake) {
  Decision decision;
  Reply reply;
  // Here, not where it arrived: what was carried out since may have filled the hand.
  if (hand_is_full(world, command)) {
    reply = {command.user, command.part, command.seq, Refusal::kNotAllowed, {}, {}};
    if (const Part* part = world.find(command.part)) reply.holder = part->holder;
    reply.text = "a user of this session holds at most " + std::to_string(limits_.parts_per_user) +
                 " parts; release one first";
  } else {
    reply = apply_command(world, command, decision);
  }
  if (reply.refusal != Refusal::kNone) {
    ++counters_.commands_refused;
    ++counters_of(command.user).commands_refused;
  } else {
    note_times(decision, now_ns);
    intake.decisions.push_back(std::move(decision));
  }
  intake.replies.push_back(std::move(reply));
}

void Inbox::note_times(const Decision& decision, std::int64_t now_ns) {
  std::vector<PartId> parts = decision.details.parts;
  if (parts.empty() && decision.part) parts.push_back(decision.part);
  for (const PartId part : parts) {
    if (decision.kind == Decision::Kind::kGrab || decision.kind == Decision::Kind::kHandOver)
      renewed_ns_[part.value - 1] = now_ns;
    if (decision.kind == Decision::Kind::kAskHandOver) asked_ns_[part.value - 1] = now_ns;
  }
}

}  // namespace mortise
