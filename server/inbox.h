#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/world.h"

namespace mortise {

struct InboxLimits {
  /// Increments and commands a second and user, as a bucket of one second. A designer's device
  /// sends at most 240 Hz; a flood of one user must not take the tick of the others.
  double messages_per_s = 1000.0;
  /// A session with more is refused: one user costs up to one broad-phase move a tick.
  std::uint32_t max_users = 256;
  /// Refusals told to one user in one tick; the rest is only counted, so that nonsense is not
  /// amplified.
  std::uint32_t refusals_told_per_tick = 8;
};

struct InboxCounters {
  std::uint64_t joins = 0, joins_refused = 0, leaves = 0, liveliness_lost = 0, lease_ends = 0;
  std::uint64_t commands = 0, commands_refused = 0, commands_deferred = 0;
  std::uint64_t increments = 0, accepted = 0;
  std::uint64_t foreign = 0;  ///< sent for a user that another participant joined as
  std::array<std::uint64_t, kRefusalCount> refused{};  ///< increments, by Refusal
  std::uint64_t refusals_untold = 0;

  std::uint64_t refused_in_all() const;
};

/// What one drain gives to the tick. Decisions are applied already, in this order.
struct Intake {
  std::vector<Decision> decisions;
  std::vector<Increment> increments;  ///< checked; per user in rising sequence
  std::vector<JoinReply> join_replies;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<Ack> acks;  ///< one per user that sent increments, by user
  bool joined = false;    ///< somebody came in: a snapshot is due

  void clear();
};

/// Sequence numbers seen, with a memory of 64: tells a repeat from one that comes too late.
class SequenceWindow {
 public:
  /// kNone: new and newest. kDuplicate: seen. kStale: older than the newest, whether lost before or
  /// not; also 0.
  Refusal admit(std::uint64_t seq);
  std::uint64_t newest() const { return newest_; }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t seen_ = 0;  ///< bit k: newest - k was seen
};

/// The door between what users send and what the tick works on: who may speak for whom, in which
/// order, how fast, about which part, and for how long a part is theirs. Many senders, read by the
/// tick thread only. Knows no clock: the time comes in.
class Inbox {
 public:
  explicit Inbox(const InboxLimits& limits) : limits_(limits) {}

  /// Checks `input`, applies joins, commands, leaves and lease ends to `world`, and puts the rest
  /// into `intake` (cleared first). now_ns never goes back.
  ///
  /// A release, undo or reset of a part for which the same drain holds increments of the same user
  /// waits for the next tick: it was sent after them, and decisions are applied before increments.
  void admit(ServerInput input, World& world, std::int64_t now_ns, Intake& intake);

  const InboxCounters& counters() const { return counters_; }
  std::uint32_t users_present() const;

 private:
  struct Seat {  ///< what the inbox knows of one user; seats_[i] is user i + 1
    ClientKey client;
    std::uint64_t nonce = 0;
    std::string role;
    bool present = false;
    SequenceWindow increments, commands;
    double tokens = 0.0;  ///< of the rate bucket
    std::int64_t tokens_at_ns = 0;
    std::uint32_t told = 0;  ///< refusals in this drain
  };
  using UserPart = std::pair<UserId, PartId>;

  Seat* seat_of(UserId user, const ClientKey& client);
  UserId first_user_of(const ClientKey& client) const;
  bool take_token(Seat& seat, std::int64_t now_ns);
  void renew(World& world, UserId user, std::int64_t now_ns);

  void admit_join(const JoinRequest& request, World& world, std::int64_t now_ns, Intake& intake);
  void admit_command(const ReceivedCommand& received, World& world, std::int64_t now_ns,
                     bool was_deferred, Intake& intake);
  void admit_increment(const ReceivedIncrement& received, const World& world, std::int64_t now_ns,
                       Intake& intake);
  Refusal judge(const Increment& increment, const World& world) const;
  void refuse(const Increment& increment, UserId tell, Refusal reason, Intake& intake);
  void depart(const std::vector<LostUser>& lost, bool said_goodbye, World& world, Intake& intake);
  void leave(UserId user, bool said_goodbye, World& world, Intake& intake);
  void end_leases(World& world, std::int64_t now_ns, Intake& intake);
  void acknowledge(UserId user, std::uint64_t seq, std::int64_t sent_ns, Intake& intake);

  InboxLimits limits_;
  InboxCounters counters_;
  std::vector<Seat> seats_;
  std::vector<std::int64_t> renewed_ns_;  ///< by part index: when its lease was last renewed
  std::vector<ReceivedCommand> deferred_;
  std::vector<LostUser> deferred_lost_;
  std::vector<UserPart> busy_;  ///< sorted: (user, part) with increments in this drain
  std::uint32_t told_strangers_ = 0;
};

}  // namespace mortise
