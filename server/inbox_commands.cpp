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
    if (is_behind(still_waiting, command) || waits(command.user, command.part, d.after)) {
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
    reply.text = "more messages a second than the session takes from one user, or from all";
  } else if (hand_is_full(world, command)) {
    reply.refusal = Refusal::kNotAllowed;
    reply.text = "a user of this session holds at most " + std::to_string(limits_.parts_per_user) +
                 " parts; release one first";
  }
  ++counters_of(reply.user).commands;
  if (reply.refusal != Refusal::kNone) {
    ++counters_.commands_refused;
    ++counters_of(reply.user).commands_refused;
    intake.replies.push_back(std::move(reply));
    return;
  }
  const std::uint64_t newest = seat->increments.newest();
  if (is_behind(deferred_, command) ||
      (waits_for_increments(command.kind) && waits(command.user, command.part, newest))) {
    ++counters_.commands_deferred;
    deferred_.push_back({received, newest});
  } else {
    carry_out(command, world, now_ns, intake);
  }
}

void Inbox::carry_out(const Command& command, World& world, std::int64_t now_ns, Intake& intake) {
  Decision decision;
  Reply reply = apply_command(world, command, decision);
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
