#include "server/command_queue.h"

#include <algorithm>
#include <utility>

#include "common/messages/names.h"
#include "common/session/world/commands.h"
#include "common/session/world/scene_edits.h"

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

bool names_mesh(const Command& command) {
  return (command.kind == CommandKind::kAddPart || command.kind == CommandKind::kReplacePart) &&
         command.details.edit.has_value();
}

// Do both touch a part in common? A group, and what names no part, may touch any.
bool touch_alike(const Command& x, const Command& y) {
  return x.user == y.user && (x.part == y.part || !x.part || !y.part);
}

}  // namespace

void CommandQueue::begin(UserId user) {
  uploads_.drop(user);
  if (user.value > sequences_.size()) sequences_.resize(user.value);
  sequences_[user.value - 1] = {};
}

void CommandQueue::receive(const Command& command, World& world, std::int64_t now_ns,
                           Intake& intake) {
  const UserId user = command.user;
  const Refusal order = sequences_[user.value - 1].admit(command.seq);
  if (order != Refusal::kNone)
    return refuse(command, user, order, std::string(name_of(order)), world, intake);
  if (!rates_.take(user, now_ns))
    return refuse(command, user, Refusal::kRateTooHigh,
                  "more messages a second than the session accepts from one user, or from all",
                  world, intake);
  ++tally_.all().commands;
  ++tally_.of(user).commands;
  const bool ends_drag = waits_for_increments(command.kind);
  Waiting waiting{command, increments_.newest(user), now_ns};
  if (ends_drag) {
    waiting.after = std::max(waiting.after, command.after);
    waiting.until_ns = now_ns + static_cast<std::int64_t>(limits_.after_wait_s * 1e9);
  }
  if (is_behind(waiting_, command) || (ends_drag && must_wait(waiting, now_ns))) {
    ++tally_.all().commands_deferred;
    waiting_.push_back(std::move(waiting));
  } else {
    carry_out(command, world, now_ns, intake);
  }
}

void CommandQueue::refuse(const Command& command, UserId tell, Refusal reason, std::string text,
                          const World& world, Intake& intake) {
  ++tally_.all().commands;
  ++tally_.of(tell).commands;
  tally_.count_refused_command(tell);
  Reply reply{tell, command.part, command.seq, reason, {}, std::move(text)};
  if (const Part* part = world.find(command.part)) reply.holder = part->holder;
  intake.replies.push_back(std::move(reply));
}

void CommandQueue::carry_out_waiting(World& world, std::int64_t now_ns, Intake& intake) {
  std::vector<Waiting> still_waiting;
  for (Waiting& waiting : std::exchange(waiting_, {})) {
    if (is_behind(still_waiting, waiting.command) || must_wait(waiting, now_ns))
      still_waiting.push_back(std::move(waiting));
    else
      carry_out(waiting.command, world, now_ns, intake);
  }
  waiting_ = std::move(still_waiting);
  for (Command& edit : std::exchange(edits_, {}))
    carry_out_edit(std::move(edit), world, now_ns, intake);
}

void CommandQueue::drop(UserId user) {
  uploads_.drop(user);
  const std::size_t undone =
      std::erase_if(waiting_, [&](const Waiting& w) { return w.command.user == user; }) +
      std::erase_if(edits_, [&](const Command& edit) { return edit.user == user; });
  for (std::size_t i = 0; i < undone; ++i) tally_.count_refused_command(user);
}

bool CommandQueue::must_wait(const Waiting& waiting, std::int64_t now_ns) {
  const Command& command = waiting.command;
  if (increments_.waits(command.user, command.part, waiting.after)) return true;
  if (increments_.newest(command.user) >= waiting.after) return false;
  if (now_ns < waiting.until_ns) return true;
  tally_.all().commands_overdue += waits_for_increments(command.kind);
  return false;
}

void CommandQueue::carry_out(const Command& command, World& world, std::int64_t now_ns,
                             Intake& intake) {
  if (!names_mesh(command) && !wanted_mesh(world, command))
    return apply(command, world, now_ns, intake);
  Command edit = command;
  if (names_mesh(edit)) edit.details.text.clear();  // it is ours: what is found in the mesh
  carry_out_edit(std::move(edit), world, now_ns, intake);
}

void CommandQueue::carry_out_edit(Command command, World& world, std::int64_t now_ns,
                                  Intake& intake) {
  // What is refused anyway does not wait.
  const User* user = world.find(command.user);
  if (user == nullptr || !user->present || user->role == Role::kObserver)
    return apply(command, world, now_ns, intake);
  if (names_mesh(command)) {
    if (check_edit(world, *user, command).refusal != Refusal::kNone)
      return apply(command, world, now_ns, intake);
    std::string& name = command.details.edit->mesh_hash;
    Uploads::Mesh mesh = uploads_.find(command.user, name, world);
    if (!is_here(mesh, command, world, intake)) return;
    // What was found in a file is told once; from then on the mesh goes by its own name.
    if (name != mesh.hash) command.details.text = std::move(mesh.text);
    name = mesh.hash;
  }
  if (const auto wanted = wanted_mesh(world, command); wanted && wanted->as)
    if (!is_here(uploads_.find(wanted->hash, *wanted->as, world), command, world, intake)) return;
  apply(command, world, now_ns, intake);
}

bool CommandQueue::is_here(const Uploads::Mesh& mesh, Command& command, const World& world,
                           Intake& intake) {
  switch (mesh.is) {
    case Uploads::Mesh::Is::kUnknown:
      answer_refused(command, Refusal::kUnknownMesh,
                     "no mesh '" + mesh.hash + "' was uploaded: send it first", world, intake);
      return false;
    case Uploads::Mesh::Is::kUnusable:
      answer_refused(command, Refusal::kUnreadableMesh, mesh.text, world, intake);
      return false;
    case Uploads::Mesh::Is::kComing:
      wait_for_mesh(std::move(command), world, intake);
      return false;
    case Uploads::Mesh::Is::kHere:
      break;
  }
  return true;
}

void CommandQueue::wait_for_mesh(Command command, const World& world, Intake& intake) {
  const auto waiting = std::ranges::count_if(
      edits_, [&](const Command& other) { return other.user == command.user; });
  if (waiting >= limits_.edits_waiting)
    return answer_refused(
        command, Refusal::kRateTooHigh,
        std::to_string(waiting) + " commands of this user wait for meshes already", world, intake);
  edits_.push_back(std::move(command));
}

void CommandQueue::answer_refused(const Command& command, Refusal reason, std::string text,
                                  const World& world, Intake& intake) {
  tally_.count_refused_command(command.user);
  Reply reply{command.user, command.part, command.seq, reason, {}, std::move(text)};
  if (const Part* part = world.find(command.part)) reply.holder = part->holder;
  intake.replies.push_back(std::move(reply));
}

void CommandQueue::apply(const Command& command, World& world, std::int64_t now_ns,
                         Intake& intake) {
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
    tally_.count_refused_command(command.user);
  } else {
    leases_.note(decision, now_ns);
    if (decision.details.edit) uploads_.note_used(decision.details.edit->mesh_hash);
    intake.decisions.push_back(std::move(decision));
  }
  intake.replies.push_back(std::move(reply));
}

bool CommandQueue::hand_is_full(const World& world, const Command& command) const {
  UserId taker;
  if (command.kind == CommandKind::kGrab || command.kind == CommandKind::kAskHandOver)
    taker = command.user;
  else if (const Part* part = world.find(command.part);
           part != nullptr && command.kind == CommandKind::kConsent)
    taker = part->asked_by;
  if (!taker) return false;
  std::vector<PartId> wanted = command.details.parts;
  if (wanted.empty()) wanted.push_back(command.part);
  std::size_t held = 0;
  for (const std::uint32_t i : leases_.moving()) {
    const Part& part = world.parts[i];
    if (part.holder != taker) continue;
    ++held;
    std::erase(wanted, part.id);  // held already
  }
  return !wanted.empty() && held + wanted.size() > limits_.parts_per_user;
}

bool CommandQueue::is_behind(const std::vector<Waiting>& waiting, const Command& command) {
  return std::any_of(waiting.begin(), waiting.end(),
                     [&](const Waiting& other) { return touch_alike(other.command, command); });
}

}  // namespace mortise
