#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "common/session/world/world.h"
#include "server/inbox_tally.h"
#include "server/increment_order.h"
#include "server/intake.h"
#include "server/leases.h"
#include "server/message_rates.h"

namespace mortise {

/// The increments of all users: restores the order in which they were sent, checks them, and gives
/// each tick a share of every user. Acknowledges accepted and refused increments in order; of a
/// user who repeats, an acknowledgement implies that each refusal up to it was told.
class IncrementAdmission {
 public:
  /// All must outlive this.
  IncrementAdmission(const InboxLimits& limits, InboxTally& tally, MessageRates& rates,
                     Leases& leases)
      : limits_(limits), tally_(tally), rates_(rates), leases_(leases) {}

  /// A user has joined. `is_back`: the same program that was this user before. Its sequence numbers
  /// go on, and what was acknowledged is not taken again; else they begin again.
  void begin(UserId user, bool is_back);
  /// An increment of a user who has joined: checks order and rate.
  void receive(const ReceivedIncrement& received, std::int64_t now_ns, Intake& intake);
  /// Takes this tick's share of each user, checked against the present holders.
  void take(const World& world, std::int64_t now_ns, Intake& intake);
  /// The user has left. Increments that wait are refused without a message, because the next user
  /// with this id must not receive it.
  void drop(UserId user);

  bool waits(UserId user, PartId part, std::uint64_t up_to_seq) const;  ///< no part: any
  std::uint64_t newest(UserId user) const { return queues_[user.value - 1].order.newest(); }
  std::size_t waiting() const { return waiting_; }

 private:
  struct Queue {  ///< of one user
    IncrementOrder order;
    std::uint64_t lost = 0, repaired = 0;  ///< counted of that order
    std::uint64_t acknowledged = 0;
    std::deque<ReceivedIncrement> backlog;        ///< in rising sequence
    std::uint64_t refused_up_to = 0;              ///< behind it: acknowledged when that is empty
    std::uint32_t queued = 0, queued_before = 0;  ///< in this second and the last one
    std::int64_t second_ns = 0;                   ///< when this second began
  };
  /// What is in order: into the backlog, or refused.
  void queue_next(UserId user, std::int64_t now_ns, Intake& intake);
  void queue(const ReceivedIncrement& received, Refusal reason, std::int64_t now_ns,
             Intake& intake);
  void count(UserId user);
  Refusal refusal_at_queue(const ReceivedIncrement& received, std::int64_t now_ns);
  std::size_t share_of(const Queue& queue, const World& world) const;
  /// False: it is refused, and that cannot be told in this tick.
  bool take_first(UserId user, const World& world, std::int64_t now_ns, Intake& intake);
  /// Removes the first increment of the backlog, and acknowledges it.
  Increment next(UserId user, Intake& intake);
  Increment pop(Queue& of_user);
  /// sent_ns 0: no latency can be told from this one.
  void acknowledge(UserId user, std::uint64_t seq, std::int64_t sent_ns, Intake& intake);

  const InboxLimits& limits_;
  InboxTally& tally_;
  MessageRates& rates_;
  Leases& leases_;
  std::vector<Queue> queues_;  ///< by user index
  std::size_t waiting_ = 0;    ///< in all backlogs
};

}  // namespace mortise
