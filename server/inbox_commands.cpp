#include "server/inbox.h"

#include <algorithm>
#include <utility>

#include "common/messages/names.h"

namespace mortise {
namespace {

bool waits_for_increments(CommandKind kind) {
  return kind == CommandKind::kRelease || kind == CommandKind::kUndo || kind == CommandKind::kReset;
}

}  // namespace

bool Inbox::is_behind(const std::vector<DeferredCommand>& waiting, const Command& command) {
  return std::any_of(waiting.begin(), waiting.end(), [&](const DeferredCommand& other) {
    return other.received.command.user == command.user &&
           other.received.command.part == command.part;
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
  } else if (command.kind == CommandKind::kGrab && seat->role == "observer") {
    reply.refusal = Refusal::kNotAllowed;
    reply.text = "observers do not hold parts";
  } else if (command.kind == CommandKind::kGrab && hand_is_full(world, command)) {
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
    if (command.kind == CommandKind::kGrab) renewed_ns_[command.part.value - 1] = now_ns;
    intake.decisions.push_back(std::move(decision));
  }
  intake.replies.push_back(std::move(reply));
}

}  // namespace mortise
