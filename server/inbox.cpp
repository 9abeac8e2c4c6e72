#include "server/inbox.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/messages/names.h"
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

}  // namespace

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

}  // namespace mortise
