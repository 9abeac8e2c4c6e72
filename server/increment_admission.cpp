#include "server/increment_admission.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/session/world/rights.h"

namespace mortise {
namespace {

// What of a user is queued is counted by the second, and forgotten after two.
constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

void IncrementAdmission::begin(UserId user, bool is_back) {
  if (user.value > queues_.size()) queues_.resize(user.value);
  const std::uint64_t handled = is_back ? queues_[user.value - 1].acknowledged : 0;
  queues_[user.value - 1] = {};
  queues_[user.value - 1].order = IncrementOrder::after(handled);
  queues_[user.value - 1].acknowledged = handled;
}

void IncrementAdmission::receive(const ReceivedIncrement& received, std::int64_t now_ns,
                                 Intake& intake) {
  const Increment& increment = received.increment;
  Queue& of_user = queues_[increment.user.value - 1];
  const IncrementOrder::Arrival arrival = of_user.order.receive(received);
  queue_next(increment.user, now_ns, intake);
  if (arrival == IncrementOrder::Arrival::kNoRoom) return;  // it comes again
  const bool seen = arrival == IncrementOrder::Arrival::kSeen;
  if (seen && received.kept_from != 0) {
    ++tally_.all().repeats;
    // The acknowledgement may have been lost.
    if (increment.seq <= of_user.acknowledged)
      acknowledge(increment.user, of_user.acknowledged, 0, intake);
    return;
  }
  ++tally_.all().increments;
  ++tally_.of(increment.user).received;
  if (arrival == IncrementOrder::Arrival::kNew) return;
  tally_.refuse(increment, increment.user, seen ? Refusal::kDuplicate : Refusal::kStale, intake);
}

Refusal IncrementAdmission::refusal_at_queue(const ReceivedIncrement& received,
                                             std::int64_t now_ns) {
  if (received.at_door != Refusal::kNone) return received.at_door;
  const UserId user = received.increment.user;
  const bool is_full = queues_[user.value - 1].backlog.size() >= limits_.increments_waiting;
  return is_full || !rates_.has_room(user, now_ns) ? Refusal::kRateTooHigh : Refusal::kNone;
}

void IncrementAdmission::queue_next(UserId user, std::int64_t now_ns, Intake& intake) {
  IncrementOrder& order = queues_[user.value - 1].order;
  while (const ReceivedIncrement* first = order.next()) {
    const Refusal reason = refusal_at_queue(*first, now_ns);
    // Later acknowledgements would say that it was taken. Who never repeats has given it up.
    const bool repeats = first->kept_from != 0;
    if (reason != Refusal::kNone && repeats && !tally_.can_tell(user)) break;
    queue(order.take_next(), reason, now_ns, intake);
  }
  count(user);
}

void IncrementAdmission::count(UserId user) {
  Queue& of_user = queues_[user.value - 1];
  const std::uint64_t lost = of_user.order.lost(), repaired = of_user.order.repaired();
  tally_.all().lost += lost - of_user.lost;
  tally_.all().repaired += repaired - of_user.repaired;
  tally_.of(user).lost += lost - of_user.lost;
  tally_.of(user).repaired += repaired - of_user.repaired;
  of_user.lost = lost;
  of_user.repaired = repaired;
}

void IncrementAdmission::queue(const ReceivedIncrement& received, Refusal reason,
                               std::int64_t now_ns, Intake& intake) {
  const Increment& increment = received.increment;
  Queue& of_user = queues_[increment.user.value - 1];
  if (received.at_door == Refusal::kNone) (void)rates_.take(increment.user, now_ns);
  if (reason != Refusal::kNone) {
    // An acknowledgement speaks of all before it, also of what waits.
    if (of_user.backlog.empty())
      acknowledge(increment.user, increment.seq, received.sent_ns, intake);
    else
      of_user.refused_up_to = increment.seq;
    tally_.refuse(increment, increment.user, reason, intake);
    return;
  }
  if (now_ns - of_user.second_ns >= kSecond_ns) {
    of_user.queued_before = now_ns - of_user.second_ns < 2 * kSecond_ns ? of_user.queued : 0;
    of_user.queued = 0;
    of_user.second_ns = now_ns;
  }
  ++of_user.queued;
  of_user.backlog.push_back(received);
  ++waiting_;
}

std::size_t IncrementAdmission::share_of(const Queue& queue, const World& world) const {
  const double sent_per_s = std::max(queue.queued, queue.queued_before);
  return std::max<std::size_t>(
      limits_.increments_per_tick,
      static_cast<std::size_t>(std::ceil(2.0 * sent_per_s / world.tick_rate_hz)));
}

void IncrementAdmission::take(const World& world, std::int64_t now_ns, Intake& intake) {
  for (std::uint32_t i = 0; i < queues_.size(); ++i) {
    const Queue& of_user = queues_[i];
    queue_next(UserId{i + 1}, now_ns, intake);
    const std::size_t before = intake.increments.size(), share = share_of(of_user, world);
    // Also what would be refused waits its turn: the sequence of a user never goes back.
    while (!of_user.backlog.empty() && intake.increments.size() - before < share &&
           take_first(UserId{i + 1}, world, now_ns, intake)) {
    }
  }
  tally_.all().longest_backlog = std::max<std::uint64_t>(tally_.all().longest_backlog, waiting_);
}

bool IncrementAdmission::take_first(UserId user, const World& world, std::int64_t now_ns,
                                    Intake& intake) {
  const Refusal reason = refusal_of(world, queues_[user.value - 1].backlog.front().increment);
  // An acknowledgement would say that it was taken.
  if (reason != Refusal::kNone && !tally_.can_tell(user)) return false;
  const Increment increment = next(user, intake);
  if (reason != Refusal::kNone) {
    tally_.refuse(increment, user, reason, intake);
    return true;
  }
  leases_.renew(increment.part, now_ns);
  ++tally_.all().accepted;
  ++tally_.of(user).accepted;
  intake.increments.push_back(increment);
  return true;
}

Increment IncrementAdmission::next(UserId user, Intake& intake) {
  Queue& of_user = queues_[user.value - 1];
  const std::int64_t sent_ns = of_user.backlog.front().sent_ns;
  const Increment first = pop(of_user);
  acknowledge(user, first.seq, sent_ns, intake);
  if (of_user.backlog.empty() && of_user.refused_up_to > first.seq)
    acknowledge(user, of_user.refused_up_to, 0, intake);
  return first;
}

Increment IncrementAdmission::pop(Queue& of_user) {
  const Increment first = of_user.backlog.front().increment;
  of_user.backlog.pop_front();
  --waiting_;
  return first;
}

void IncrementAdmission::drop(UserId user) {
  Queue& of_user = queues_[user.value - 1];
  Intake nobody;
  while (!of_user.backlog.empty()) tally_.refuse(pop(of_user), user, Refusal::kUnknownUser, nobody);
  begin(user, true);
}

bool IncrementAdmission::waits(UserId user, PartId part, std::uint64_t up_to_seq) const {
  if (!user || user.value > queues_.size()) return false;
  const std::deque<ReceivedIncrement>& backlog = queues_[user.value - 1].backlog;
  return std::any_of(backlog.begin(), backlog.end(), [&](const ReceivedIncrement& r) {
    return (!part || r.increment.part == part) && r.increment.seq <= up_to_seq;
  });
}

void IncrementAdmission::acknowledge(UserId user, std::uint64_t seq, std::int64_t sent_ns,
                                     Intake& intake) {
  std::uint64_t& acknowledged = queues_[user.value - 1].acknowledged;
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
