#include "server/inbox.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/base/plain_text.h"
#include "common/messages/names.h"
#include "common/session/world/decisions.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

constexpr std::uint64_t kEverySeq = std::numeric_limits<std::uint64_t>::max();

// So long users of a server that is gone may take to be heard again: twice a participant's lease.
constexpr double kAwaitAdopted_s = 4.0;

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

// `in_use`: a user of that name is present. `most_users`: as many as are present already; 0: there
// is room.
Refusal check_join(const JoinRequest& request, const World& world, bool in_use,
                   std::uint64_t most_users, std::string& text) {
  const std::optional<Role> role = role_named(request.role);
  const Role wanted = role_wanted(world, request.name);
  if (!is_name(request.name, kMostUserName_bytes)) {
    text = "a name has 1 to 64 bytes of printable UTF-8, and is not blank";
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
  if (in_use) {
    text = "the name '" + request.name + "' is in use in this session; choose another";
    return Refusal::kNotAllowed;
  }
  if (most_users > 0) {
    text = "the session has its " + std::to_string(most_users) + " users already";
    return Refusal::kSessionFull;
  }
  return Refusal::kNone;
}

}  // namespace

void Inbox::admit(ServerInput input, World& world, std::int64_t now_ns, Intake& intake) {
  intake.clear();
  intake.turned_away = std::move(input.turned_away);
  intake.follower_came = input.follower_came;
  intake.superseded = input.superseded;
  intake.superseded_by = std::move(input.superseded_by);
  leases_.begin_drain(world, now_ns);
  tally_.begin_drain();

  // 1. What waited for increments of earlier ticks, or for a mesh.
  commands_.carry_out_waiting(world, now_ns, intake);
  say_waiting_goodbyes(world, intake);

  // 2. Who is gone without a word (and may be among those who come in), and who comes in.
  depart(input.lost, false, world, intake);
  for (const JoinRequest& request : input.joins) admit_join(request, world, now_ns, intake);

  // 3. What came from users: increments first, so that a command knows what was sent before it.
  for (const UserId user : input.heartbeats)
    if (is_present(user)) leases_.renew_all(world, user, now_ns);
  for (const ReceivedIncrement& r : input.increments) admit_increment(r, now_ns, intake);
  for (auto& [client, piece] : input.pieces)
    if (speaks_for(client, piece.user)) uploads_.receive(std::move(piece), world);
  for (const ReceivedCommand& c : input.commands) admit_command(c, world, now_ns, intake);
  increments_.take(world, now_ns, intake);

  // 4. Who says goodbye, and whose lease is over.
  depart(input.lost, true, world, intake);
  end_waiting(world, now_ns, intake);
  end_leases(world, now_ns, intake);
}

// 1. who is there

std::uint32_t Inbox::users_present() const {
  return static_cast<std::uint32_t>(
      std::count_if(seats_.begin(), seats_.end(), [](const Seat& seat) { return seat.present; }));
}

bool Inbox::speaks_for(const ClientKey& client, UserId user) {
  if (!is_present(user)) return false;
  if (seats_[user.value - 1].client == client) return true;
  ++tally_.all().foreign;
  return false;
}

UserId Inbox::first_user_of(const ClientKey& client) const {
  for (std::uint32_t i = 0; i < seats_.size(); ++i)
    if (seats_[i].present && seats_[i].client == client) return UserId{i + 1};
  return UserId{};
}

std::uint32_t Inbox::seats_for(const ClientKey& client) const {
  return limits_.max_users - (first_user_of(client) ? limits_.max_users / kKeptForOthers : 0);
}

UserId Inbox::user_who_asked(const JoinRequest& request) const {
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    const Seat& seat = seats_[i];
    if (seat.present && seat.client == request.client && seat.nonce == request.nonce)
      return UserId{i + 1};
  }
  return UserId{};
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

void Inbox::sit_down(UserId user, const Seat& seat, bool with_taken_id, std::int64_t now_ns) {
  if (user.value > seats_.size()) seats_.resize(user.value);
  const Seat before = std::exchange(seats_[user.value - 1], seat);
  tally_.begin(user, with_taken_id);
  rates_.begin(user, now_ns);
  increments_.begin(user, before.client == seat.client && before.nonce == seat.nonce);
  commands_.begin(user);
}

void Inbox::adopt(const std::vector<SeatRecord>& seats, std::int64_t now_ns) {
  const auto until_ns = now_ns + static_cast<std::int64_t>(kAwaitAdopted_s * 1e9);
  for (const SeatRecord& record : seats)
    sit_down(record.user, {record.client, record.nonce, true, 0, until_ns}, false, now_ns);
}

std::vector<SeatRecord> Inbox::seats() const {
  std::vector<SeatRecord> records;
  for (std::uint32_t i = 0; i < seats_.size(); ++i)
    if (const Seat& seat = seats_[i]; seat.present)
      records.push_back({UserId{i + 1}, seat.client, seat.nonce});
  return records;
}

void Inbox::admit_join(const JoinRequest& request, World& world, std::int64_t now_ns,
                       Intake& intake) {
  JoinReply reply{request.client, request.nonce, {}, Refusal::kNone, {}};
  reply.user = user_who_asked(request);
  if (reply.user) {  // asked again because the answer was lost
    seats_[reply.user.value - 1].awaited_until_ns = 0;
    intake.join_replies.push_back(std::move(reply));
    intake.joined = true;
    return;
  }
  if (puts_off_newcomers_) {
    ++tally_.all().joins_put_off;
    return;
  }
  UserId known;  // a user of that name who left: the same user again
  for (const User& user : world.users)
    if (user.name == request.name) known = user.id;
  const std::uint32_t seats = seats_for(request.client);
  reply.refusal = check_join(request, world, is_present(known),
                             users_present() >= seats ? seats : 0, reply.text);
  if (reply.refusal != Refusal::kNone) {
    ++tally_.all().joins_refused;
    intake.join_replies.push_back(std::move(reply));
    return;
  }

  Decision decision{Decision::Kind::kJoin, known, {}, {}};
  if (!known && world.users.size() >= std::max(limits_.names_kept, limits_.max_users)) {
    decision.user = longest_gone(world);
    if (const User* gone = world.find(decision.user)) decision.details.text = gone->name;
  }
  if (!decision.user) decision.user = UserId{static_cast<std::uint32_t>(world.users.size()) + 1};
  decision.user_name = request.name;
  decision.role = role_named(request.role).value_or(Role::kUnknown);
  sit_down(decision.user, {request.client, request.nonce, true}, takes_over_id(decision), now_ns);
  ++tally_.all().joins;
  reply.user = decision.user;
  intake.joined = true;
  decide(decision, world, intake);
  intake.join_replies.push_back(std::move(reply));
}

// 2. what they send

void Inbox::admit_increment(const ReceivedIncrement& received, std::int64_t now_ns,
                            Intake& intake) {
  const Increment& increment = received.increment;
  if (speaks_for(received.client, increment.user))
    return increments_.receive(received, now_ns, intake);
  ++tally_.all().increments;
  tally_.refuse(increment, first_user_of(received.client), Refusal::kUnknownUser, intake);
}

void Inbox::admit_command(const ReceivedCommand& received, World& world, std::int64_t now_ns,
                          Intake& intake) {
  if (speaks_for(received.client, received.command.user))
    return commands_.receive(received.command, world, now_ns, intake);
  commands_.refuse(received.command, first_user_of(received.client), Refusal::kUnknownUser,
                   "the sender has not joined as this user", world, intake);
}

// 3. who goes, and what ends

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
        if (gone.user) ++tally_.all().foreign;
        continue;
      }
      // Who said goodbye before closing the door leaves in order.
      if (said_goodbye)
        say_goodbye(user, world, intake);
      else if (!says_goodbye(user))
        leave(user, false, world, intake);
    }
  }
}

// After the increments of before.
void Inbox::say_goodbye(UserId user, World& world, Intake& intake) {
  const bool has_some = std::any_of(intake.increments.begin(), intake.increments.end(),
                                    [&](const Increment& r) { return r.user == user; });
  if (has_some || increments_.waits(user, PartId{}, increments_.newest(user)))
    goodbyes_.push_back({user, increments_.newest(user)});
  else
    leave(user, true, world, intake);
}

void Inbox::say_waiting_goodbyes(World& world, Intake& intake) {
  std::erase_if(goodbyes_, [&](const DeferredGoodbye& goodbye) {
    if (increments_.waits(goodbye.user, PartId{}, goodbye.after)) return false;
    leave(goodbye.user, true, world, intake);
    return true;
  });
}

void Inbox::leave(UserId user, bool said_goodbye, World& world, Intake& intake) {
  Seat& seat = seats_[user.value - 1];
  if (!seat.present) return;
  seat.present = false;
  seat.left = ++departures_;
  increments_.drop(user);
  commands_.drop(user);
  ++(said_goodbye ? tally_.all().leaves : tally_.all().liveliness_lost);
  decide({said_goodbye ? Decision::Kind::kLeave : Decision::Kind::kLivelinessLost, user, {}, {}},
         world, intake);
}

void Inbox::end_waiting(World& world, std::int64_t now_ns, Intake& intake) {
  for (std::uint32_t i = 0; i < seats_.size(); ++i) {
    const Seat& seat = seats_[i];
    if (seat.present && seat.awaited_until_ns != 0 && now_ns > seat.awaited_until_ns)
      leave(UserId{i + 1}, false, world, intake);
  }
}

void Inbox::end_leases(World& world, std::int64_t now_ns, Intake& intake) {
  const auto moved = [this](UserId user, PartId part) {
    return increments_.waits(user, part, kEverySeq);
  };
  for (const Decision& end : leases_.ended(world, now_ns, moved)) {
    ++tally_.all().lease_ends;
    decide(end, world, intake);
  }
}

void Inbox::decide(const Decision& decision, World& world, Intake& intake) {
  apply_decision(world, decision);
  intake.decisions.push_back(decision);
}

}  // namespace mortise
