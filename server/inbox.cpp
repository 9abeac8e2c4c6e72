#include "server/inbox.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/base/constants.h"
#include "common/messages/names.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

constexpr std::uint64_t kEverySeq = std::numeric_limits<std::uint64_t>::max();

// So long users of a server that is gone may take to be heard again: twice a participant's lease.
constexpr double kAwaitAdopted_s = 4.0;

bool printable(const std::string& name) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return !name.empty() && name.size() <= 64 && std::none_of(name.begin(), name.end(), control);
}

// What a proven identity may join as; empty: as this.
std::string why_not(const Identity& identity, const std::string& name, Role role) {
  const std::string whose = "the certificate of '" + identity.name + "' ";
  const bool looks_on = role == Role::kObserver;
  // A gateway speaks for people whose tokens it knows; a bot has several hands under its own name.
  const bool own_name = identity.role == "gateway" || name == identity.name ||
                        (identity.role == "bot" && name.starts_with(identity.name + "-"));
  if (!own_name) return whose + "does not let its owner join as '" + name + "'";
  const bool own_role = identity.role == "gateway" || looks_on ||
                        (identity.role == "designer" && role == Role::kDesigner) ||
                        (identity.role == "bot" && role == Role::kBot);
  if (!own_role)
    return whose + "is one of role " + identity.role + ", not of " + std::string(name_of(role));
  return {};
}

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

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

// 1. who is there

std::uint64_t InboxCounters::refused_in_all() const {
  std::uint64_t sum = 0;
  for (std::uint64_t count : refused) sum += count;
  return sum;
}

void Intake::clear() {
  decisions.clear();
  increments.clear();
  join_replies.clear();
  replies.clear();
  refused.clear();
  acks.clear();
  turned_away.clear();
  follower_came = superseded = false;
  joined = false;
}

std::uint32_t Inbox::users_present() const {
  return static_cast<std::uint32_t>(
      std::count_if(seats_.begin(), seats_.end(), [](const Seat& seat) { return seat.present; }));
}

Inbox::Seat* Inbox::seat_of(UserId user, const ClientKey& client) {
  if (!user || user.value > seats_.size()) return nullptr;
  Seat& seat = seats_[user.value - 1];
  if (!seat.present) return nullptr;
  if (seat.client != client) {
    ++counters_.foreign;
    return nullptr;
  }
  return &seat;
}

UserId Inbox::longest_gone(const World& world) const {
  UserId longest;
  std::uint64_t left = 0;
  for (const User& user : world.users) {
    const Seat* seat = user.id.value <= seats_.size() ? &seats_[user.id.value - 1] : nullptr;
    if (user.present || (seat != nullptr && seat->present)) continue;
    const std::uint64_t when = seat != nullptr ? seat->left : 0;
    if (longest && when >= left) continue;
    longest = user.id;
    left = when;
  }
  return longest;
}

UserId Inbox::first_user_of(const ClientKey& client) const {
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    if (seats_[i].present && seats_[i].client == client) return UserId{i + 1};
  }
  return UserId{};
}

bool Inbox::take_token(Seat& seat, std::int64_t now_ns) {
  const auto refill = [&](double& tokens, std::int64_t since_ns, double rate) {
    tokens = std::min(rate, tokens + static_cast<double>(now_ns - since_ns) * 1e-9 * rate);
  };
  if (!session_tokens_at_ns_) session_tokens_ = limits_.session_messages_per_s;
  refill(session_tokens_, session_tokens_at_ns_.value_or(now_ns), limits_.session_messages_per_s);
  session_tokens_at_ns_ = now_ns;
  refill(seat.tokens, seat.tokens_at_ns, limits_.messages_per_s);
  seat.tokens_at_ns = now_ns;
  if (seat.tokens < 1.0 || session_tokens_ < 1.0) return false;
  seat.tokens -= 1.0;
  session_tokens_ -= 1.0;
  return true;
}

bool Inbox::hand_is_full(const World& world, const Command& command) const {
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
  for (const std::uint32_t i : moving_) {
    const Part& part = world.parts[i];
    if (part.holder != taker) continue;
    ++held;
    std::erase(wanted, part.id);  // held already
  }
  return !wanted.empty() && held + wanted.size() > limits_.parts_per_user;
}

void Inbox::renew(World& world, UserId user, std::int64_t now_ns) {
  for (const std::uint32_t i : moving_) {
    if (world.parts[i].holder == user) renewed_ns_[i] = now_ns;
  }
}

void Inbox::admit(ServerInput input, World& world, std::int64_t now_ns, Intake& intake) {
  intake.clear();
  intake.turned_away = std::move(input.turned_away);
  intake.follower_came = input.follower_came;
  intake.superseded = input.superseded;
  if (renewed_ns_.size() != world.parts.size()) {
    renewed_ns_.resize(world.parts.size(), now_ns);
    moving_.clear();
    for (std::uint32_t i = 0; i < world.parts.size(); ++i) {
      if (world.parts[i].moving) moving_.push_back(i);
    }
  }
  asked_ns_.resize(world.parts.size(), now_ns);
  for (Seat& seat : seats_) seat.told = 0;
  told_strangers_ = 0;

  // 1. What waited for increments of earlier ticks.
  carry_out_deferred(world, now_ns, intake);

  // 2. Who is gone without a word (and may be among those who come in), and who comes in.
  depart(input.lost, false, world, intake);
  for (const JoinRequest& request : input.joins) admit_join(request, world, now_ns, intake);

  // 3. What came from users: increments first, so that a command knows what was sent before it.
  for (UserId user : input.heartbeats) {
    if (user && user.value <= seats_.size() && seats_[user.value - 1].present) {
      renew(world, user, now_ns);
    }
  }
  for (const ReceivedIncrement& r : input.increments) receive_increment(r, now_ns, intake);
  for (const ReceivedCommand& command : input.commands) {
    admit_command(command, world, now_ns, intake);
  }
  take_increments(world, now_ns, intake);

  // 4. Who says goodbye, and whose lease is over.
  depart(input.lost, true, world, intake);
  end_waiting(world, now_ns, intake);
  end_leases(world, now_ns, intake);
  end_asks(world, now_ns, intake);
}

Refusal Inbox::check_join(const JoinRequest& request, const World& world, UserId known,
                          std::string& text) const {
  const std::optional<Role> role = role_named(request.role);
  const Role wanted = role_wanted(world, request.name);
  if (!printable(request.name)) {
    text = "a name has 1 to 64 printable characters";
    return Refusal::kNotAllowed;
  }
  if (!role) {
    text = "'" + request.role + "' is no role; join as designer, observer or bot";
    return Refusal::kNotAllowed;
  }
  if (request.identity) {
    text = why_not(*request.identity, request.name, *role);
    if (!text.empty()) return Refusal::kNotAllowed;
  }
  if (wanted != Role::kUnknown && wanted != *role) {
    text = "the scenario has '" + request.name + "' as " + std::string(name_of(wanted)) +
           ", not as " + request.role;
    return Refusal::kNotAllowed;
  }
  if (known && known.value <= seats_.size() && seats_[known.value - 1].present) {
    text = "the name '" + request.name + "' is in use in this session; choose another";
    return Refusal::kNotAllowed;
  }
  if (users_present() >= limits_.max_users) {
    text = "the session has its " + std::to_string(limits_.max_users) + " users already";
    return Refusal::kSessionFull;
  }
  return Refusal::kNone;
}

void Inbox::admit_join(const JoinRequest& request, World& world, std::int64_t now_ns,
                       Intake& intake) {
  JoinReply reply{request.client, request.nonce, {}, Refusal::kNone, {}};
  UserId known;  // a user of that name who left: the same user again
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    Seat& seat = seats_[i];
    if (seat.present && seat.client == request.client && seat.nonce == request.nonce) {
      seat.awaited_until_ns = 0;
      reply.user = UserId{i + 1};  // asked again because the answer was lost
      intake.join_replies.push_back(std::move(reply));
      intake.joined = true;
      return;
    }
  }
  if (puts_off_newcomers_) {
    ++counters_.joins_put_off;
    return;
  }
  for (const User& user : world.users) {
    if (user.name == request.name) known = user.id;
  }
  reply.refusal = check_join(request, world, known, reply.text);
  if (reply.refusal != Refusal::kNone) {
    ++counters_.joins_refused;
    intake.join_replies.push_back(std::move(reply));
    return;
  }

  Decision decision;
  decision.kind = Decision::Kind::kJoin;
  decision.user = known;
  if (!known && world.users.size() >= std::max(limits_.names_kept, limits_.max_users)) {
    decision.user = longest_gone(world);
    if (const User* gone = world.find(decision.user)) decision.details.text = gone->name;
  }
  if (!decision.user) decision.user = UserId{static_cast<std::uint32_t>(world.users.size()) + 1};
  decision.user_name = request.name;
  decision.role = role_named(request.role).value_or(Role::kUnknown);
  apply_decision(world, decision);
  if (decision.user.value > seats_.size()) seats_.resize(decision.user.value);
  if (takes_over_id(decision)) counters_of(decision.user) = {};
  Seat& seat = seats_[decision.user.value - 1];
  seat = Seat{};
  seat.client = request.client;
  seat.nonce = request.nonce;
  seat.present = true;
  seat.tokens = limits_.messages_per_s;
  seat.tokens_at_ns = now_ns;
  ++counters_.joins;
  reply.user = decision.user;
  intake.joined = true;
  intake.decisions.push_back(std::move(decision));
  intake.join_replies.push_back(std::move(reply));
}

void Inbox::depart(const std::vector<LostUser>& lost, bool said_goodbye, World& world,
                   Intake& intake) {
  const auto says_goodbye = [&](UserId user) {
    return std::any_of(
               lost.begin(), lost.end(),
               [&](const LostUser& other) { return other.said_goodbye && other.user == user; }) ||
           std::any_of(goodbyes_.begin(), goodbyes_.end(),
                       [&](const DeferredGoodbye& other) { return other.user == user; });
  };
  for (const LostUser& gone : lost) {
    if (gone.said_goodbye != said_goodbye) continue;
    for (std::uint32_t i = 0; i < seats_.size(); ++i) {
      const UserId user{i + 1};
      if (!seats_[i].present || (gone.user && gone.user != user)) continue;
      if (!gone.client.empty() && gone.client != seats_[i].client) {
        if (gone.user) ++counters_.foreign;
        continue;
      }
      if (!said_goodbye) {
        // Who said goodbye before closing the door leaves in order.
        if (!says_goodbye(user)) leave(user, false, world, intake);
      } else if (std::any_of(intake.increments.begin(), intake.increments.end(),
                             [&](const Increment& r) { return r.user == user; }) ||
                 waits(user, PartId{}, seats_[i].increments.newest())) {
        goodbyes_.push_back({user, seats_[i].increments.newest()});
      } else {
        leave(user, true, world, intake);
      }
    }
  }
}

void Inbox::leave(UserId user, bool said_goodbye, World& world, Intake& intake) {
  Seat& seat = seats_[user.value - 1];
  if (!seat.present) return;
  seat.present = false;
  seat.left = ++departures_;
  // What waits was never carried out: who sits here next has nothing to do with it, nor is to hear
  // of it.
  const std::vector<Ack> acks = intake.acks;
  const std::size_t refused = intake.refused.size();
  while (!seat.backlog.empty()) take_first(user, world, 0, intake);
  intake.acks = acks;
  intake.refused.resize(refused);
  const std::size_t undone = std::erase_if(
      deferred_, [&](const DeferredCommand& d) { return d.received.command.user == user; });
  counters_.commands_refused += undone;
  counters_of(user).commands_refused += undone;
  ++(said_goodbye ? counters_.leaves : counters_.liveliness_lost);
  Decision decision;
  decision.kind = said_goodbye ? Decision::Kind::kLeave : Decision::Kind::kLivelinessLost;
  decision.user = user;
  apply_decision(world, decision);
  intake.decisions.push_back(std::move(decision));
}

void Inbox::adopt(const std::vector<SeatRecord>& seats, std::int64_t now_ns) {
  for (const SeatRecord& record : seats) {
    if (record.user.value > seats_.size()) seats_.resize(record.user.value);
    Seat& seat = seats_[record.user.value - 1];
    seat = Seat{};
    seat.client = record.client;
    seat.nonce = record.nonce;
    seat.present = true;
    seat.awaited_until_ns = now_ns + static_cast<std::int64_t>(kAwaitAdopted_s * 1e9);
    seat.tokens = limits_.messages_per_s;
    seat.tokens_at_ns = now_ns;
  }
}

std::vector<SeatRecord> Inbox::seats() const {
  std::vector<SeatRecord> records;
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    const Seat& seat = seats_[i];
    if (seat.present) records.push_back({UserId{i + 1}, seat.client, seat.nonce});
  }
  return records;
}

void Inbox::end_waiting(World& world, std::int64_t now_ns, Intake& intake) {
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    const Seat& seat = seats_[i];
    if (seat.present && seat.awaited_until_ns != 0 && now_ns > seat.awaited_until_ns)
      leave(UserId{i + 1}, false, world, intake);
  }
}

void Inbox::end_leases(World& world, std::int64_t now_ns, Intake& intake) {
  const auto lease_ns = static_cast<std::int64_t>(world.lease_s * 1e9);
  for (const std::uint32_t i : moving_) {
    const Part& part = world.parts[i];
    if (!part.holder || now_ns - renewed_ns_[i] <= lease_ns) continue;
    if (waits(part.holder, part.id, kEverySeq)) continue;  // moved, but not yet carried out
    ++counters_.lease_ends;
    Decision decision;
    decision.kind = Decision::Kind::kLeaseEnd;
    decision.user = part.holder;
    decision.part = part.id;
    apply_decision(world, decision);
    intake.decisions.push_back(std::move(decision));
  }
}

void Inbox::end_asks(World& world, std::int64_t now_ns, Intake& intake) {
  const auto lease_ns = static_cast<std::int64_t>(world.lease_s * 1e9);
  for (const std::uint32_t i : moving_) {
    const Part& part = world.parts[i];
    if (!part.asked_by || now_ns - asked_ns_[part.id.value - 1] <= lease_ns) continue;
    ++counters_.ask_ends;
    Decision decision;
    decision.kind = Decision::Kind::kAskEnd;
    decision.user = part.asked_by;
    decision.part = part.id;
    decision.details.other_user = part.holder;
    apply_decision(world, decision);
    intake.decisions.push_back(std::move(decision));
  }
}

// 2. commands

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

// 3. increments

bool Inbox::waits(UserId user, PartId part, std::uint64_t up_to_seq) const {
  if (!user || user.value > seats_.size()) return false;
  const std::deque<ReceivedIncrement>& backlog = seats_[user.value - 1].backlog;
  return std::any_of(backlog.begin(), backlog.end(), [&](const ReceivedIncrement& r) {
    return (!part || r.increment.part == part) && r.increment.seq <= up_to_seq;
  });
}

UserCounters& Inbox::counters_of(UserId user) {
  if (!user || user.value > seats_.size()) return strangers_;
  if (user_counters_.size() < seats_.size()) user_counters_.resize(seats_.size());
  return user_counters_[user.value - 1];
}

void Inbox::receive_increment(const ReceivedIncrement& received, std::int64_t now_ns,
                              Intake& intake) {
  const Increment& increment = received.increment;
  Seat* seat = seat_of(increment.user, received.client);
  if (seat == nullptr) {
    ++counters_.increments;
    refuse(increment, first_user_of(received.client), Refusal::kUnknownUser, intake);
    return;
  }
  IncrementOrder& order = seat->increments;
  const std::uint64_t lost = order.lost(), repaired = order.repaired();
  ready_.clear();
  const IncrementOrder::Arrival arrival = order.receive(received, ready_);
  counters_.lost += order.lost() - lost;
  counters_.repaired += order.repaired() - repaired;
  UserCounters& user = counters_of(increment.user);
  user.lost += order.lost() - lost;
  user.repaired += order.repaired() - repaired;
  for (const ReceivedIncrement& next : ready_) queue(next, now_ns, intake);
  const bool seen = arrival == IncrementOrder::Arrival::kSeen;
  if (seen && received.kept_from != 0) {
    ++counters_.repeats;
    // The acknowledgement may have been lost.
    if (increment.seq <= seat->acknowledged) {
      acknowledge(increment.user, seat->acknowledged, 0, intake);
    }
    return;
  }
  ++counters_.increments;
  ++user.received;
  if (arrival == IncrementOrder::Arrival::kNew) return;
  refuse(increment, increment.user, seen ? Refusal::kDuplicate : Refusal::kStale, intake);
}

void Inbox::queue(const ReceivedIncrement& received, std::int64_t now_ns, Intake& intake) {
  const Increment& increment = received.increment;
  Seat& seat = seats_[increment.user.value - 1];
  Refusal reason = received.at_door;
  if (reason == Refusal::kNone &&
      (!take_token(seat, now_ns) || seat.backlog.size() >= limits_.increments_waiting)) {
    reason = Refusal::kRateTooHigh;
  }
  if (reason != Refusal::kNone) {
    // An acknowledgement speaks of all before it, also of what waits.
    if (seat.backlog.empty())
      acknowledge(increment.user, increment.seq, received.sent_ns, intake);
    else
      seat.refused_up_to = increment.seq;
    refuse(increment, increment.user, reason, intake);
    return;
  }
  if (now_ns - seat.second_ns >= kSecond_ns) {
    seat.queued_before = now_ns - seat.second_ns < 2 * kSecond_ns ? seat.queued : 0;
    seat.queued = 0;
    seat.second_ns = now_ns;
  }
  ++seat.queued;
  seat.backlog.push_back(received);
  ++waiting_increments_;
}

std::size_t Inbox::share_of(const Seat& seat, const World& world) const {
  const double sent_per_s = std::max(seat.queued, seat.queued_before);
  return std::max<std::size_t>(
      limits_.increments_per_tick,
      static_cast<std::size_t>(std::ceil(2.0 * sent_per_s / world.tick_rate_hz)));
}

void Inbox::take_increments(const World& world, std::int64_t now_ns, Intake& intake) {
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    std::deque<ReceivedIncrement>& backlog = seats_[i].backlog;
    const std::size_t before = intake.increments.size(), share = share_of(seats_[i], world);
    // Also what would be refused waits its turn: the sequence of a user never goes back.
    while (!backlog.empty() && intake.increments.size() - before < share) {
      take_first(UserId{i + 1}, world, now_ns, intake);
    }
  }
  counters_.longest_backlog =
      std::max<std::uint64_t>(counters_.longest_backlog, waiting_increments_);
}

void Inbox::take_first(UserId user, const World& world, std::int64_t now_ns, Intake& intake) {
  Seat& seat = seats_[user.value - 1];
  const ReceivedIncrement first = std::move(seat.backlog.front());
  seat.backlog.pop_front();
  --waiting_increments_;
  const Increment& increment = first.increment;
  const Refusal reason = seat.present ? judge(increment, world) : Refusal::kUnknownUser;
  acknowledge(user, increment.seq, first.sent_ns, intake);
  if (seat.backlog.empty() && seat.refused_up_to > increment.seq)
    acknowledge(user, seat.refused_up_to, 0, intake);
  if (reason != Refusal::kNone) {
    refuse(increment, user, reason, intake);
    return;
  }
  renewed_ns_[increment.part.value - 1] = now_ns;
  ++counters_.accepted;
  ++counters_of(user).accepted;
  intake.increments.push_back(increment);
}

Refusal Inbox::judge(const Increment& increment, const World& world) const {
  if (!increment.translation_mm.allFinite() || !increment.rotation_rad.allFinite()) {
    return Refusal::kNotFinite;
  }
  // stableNorm: the square of a huge finite number must not become infinity unnoticed.
  if (!(increment.rotation_rad.stableNorm() <= kMaxRotationPerTick_rad)) {
    return Refusal::kRotationTooLarge;
  }
  if (!(increment.translation_mm.stableNorm() <= world.max_jump_mm)) return Refusal::kJumpTooLarge;
  const Part* part = increment.part ? world.find(increment.part) : nullptr;
  if (part == nullptr) return Refusal::kUnknownPart;
  if (!part->moving) return Refusal::kPartIsStatic;
  const User* user = world.find(increment.user);
  if (user != nullptr && user->role == Role::kObserver) return Refusal::kObserver;
  if (part->holder != increment.user) return Refusal::kNotHolder;
  return Refusal::kNone;
}

void Inbox::refuse(const Increment& increment, UserId tell, Refusal reason, Intake& intake) {
  ++counters_.refused[static_cast<std::size_t>(reason)];
  ++counters_of(tell).refused;
  const bool known = tell && tell.value <= seats_.size();
  std::uint32_t& told = known ? seats_[tell.value - 1].told : told_strangers_;
  if (told >= limits_.refusals_told_per_tick) {
    ++counters_.refusals_untold;
    return;
  }
  ++told;
  intake.refused.push_back({tell, increment.part, increment.seq, reason});
}

void Inbox::acknowledge(UserId user, std::uint64_t seq, std::int64_t sent_ns, Intake& intake) {
  std::uint64_t& acknowledged = seats_[user.value - 1].acknowledged;
  acknowledged = std::max(acknowledged, seq);
  const auto at = std::lower_bound(intake.acks.begin(), intake.acks.end(), user,
                                   [](const Ack& ack, UserId id) { return ack.user < id; });
  if (at == intake.acks.end() || at->user != user) {
    intake.acks.insert(at, Ack{user, seq, sent_ns});
    return;
  }
  if (seq > at->seq && sent_ns != 0) at->sent_ns = sent_ns;
  if (at->sent_ns == 0) at->sent_ns = sent_ns;
  at->seq = std::max(at->seq, seq);
}

}  // namespace mortise
