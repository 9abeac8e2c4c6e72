#include "server/inbox.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/constants.h"

namespace mortise {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

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
