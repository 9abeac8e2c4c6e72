#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/world/world.h"
#include "server/increment_order.h"
#include "server/sequence_window.h"
#include "server/tick_bytes.h"

namespace mortise {

struct InboxLimits {
  /// Increments and commands a second and user, as a bucket of one second. A designer's device
  /// sends at most 240 Hz; a flood of one user must not take the tick of the others.
  double messages_per_s = 1000.0;
  /// The same for all users together: what a tick can take in without being late for all.
  double session_messages_per_s = 100'000.0;
  /// A session with more is refused: one user costs up to one broad-phase move a tick.
  std::uint32_t max_users = 256;
  /// Names that the session remembers, of present and absent users: an id each, in every snapshot.
  /// A further name gets the id of the user who has been absent longest. At least max_users.
  std::uint32_t names_kept = 1024;
  /// Refusals sent to one user in one tick; further ones are only counted, so that a flood is not
  /// amplified.
  std::uint32_t refusals_told_per_tick = 8;
  /// Increments of one user in one tick; more wait for the next ticks, in order. Twice what the
  /// user sends in the time of a tick, but at least so many: a backlog shrinks as fast as it grew,
  /// at whatever rate the session ticks. Without it the increments that piled up in one slow tick
  /// would make the next one a single long leap, slower still.
  std::uint32_t increments_per_tick = 8;
  /// Increments of one user that may wait; more are refused (kRateTooHigh). One second of the
  /// highest rate, or four of a 240 Hz device: the session may stand still for that long.
  std::uint32_t increments_waiting = 1000;
  /// Parts that one user may hold; more are refused at the grab, because a user who holds all parts
  /// keeps the others from working.
  std::uint32_t parts_per_user = 64;
  /// How long a command waits for earlier increments of its sender that have not arrived: ten
  /// repetitions. Then it is applied without them, and counted.
  double after_wait_s = 0.5;
};

/// What one user has sent since the session began here, and its outcome.
struct UserCounters {
  std::uint64_t received = 0;  ///< increments without repetitions
  std::uint64_t accepted = 0, refused = 0;
  std::uint64_t repaired = 0;  ///< arrived only by repetition
  std::uint64_t lost = 0;      ///< numbered by the user, and never arrived
  std::uint64_t commands = 0, commands_refused = 0;
};

struct InboxCounters {
  std::uint64_t joins = 0, joins_refused = 0, leaves = 0, liveliness_lost = 0, lease_ends = 0,
                ask_ends = 0;
  std::uint64_t joins_put_off = 0;  ///< not answered by a server that is about to end
  std::uint64_t commands = 0, commands_refused = 0, commands_deferred = 0;
  std::uint64_t commands_overdue = 0;  ///< applied without increments that were sent before them
  std::uint64_t increments = 0, accepted = 0;  ///< arrived for the first time; of these taken
  std::uint64_t repeats = 0;                   ///< arrived again: repetition repairs a lossy link
  std::uint64_t repaired = 0;                  ///< arrived only by repetition
  std::uint64_t lost = 0;                      ///< numbered by their sender, and never arrived
  std::uint64_t foreign = 0;  ///< sent for a user that another participant joined as
  std::array<std::uint64_t, kRefusalCount> refused{};  ///< increments, by Refusal
  std::uint64_t refusals_untold = 0;
  std::uint64_t longest_backlog = 0;  ///< increments that waited for a later tick, at most

  std::uint64_t refused_in_all() const;
};

/// The result of one drain for the tick. The decisions are already applied, in this order.
struct Intake {
  std::vector<Decision> decisions;
  std::vector<Increment> increments;  ///< checked; per user in rising sequence
  std::vector<JoinReply> join_replies;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<Ack> acks;                           ///< one per user that sent increments, by user
  std::vector<std::string> turned_away;            ///< by the transport, in words
  bool follower_came = false, superseded = false;  ///< see ServerInput
  bool joined = false;                             ///< a user has joined: a snapshot is due

  void clear();
};

/// Checks and orders what users send before the tick works on it: who may send for which user, in
/// which order, how fast, about which part, and how long a user keeps a part. Many senders, read by
/// the tick thread only. Has no clock: the time is passed in.
class Inbox {
 public:
  explicit Inbox(const InboxLimits& limits) : limits_(limits) {}

  /// Checks `input`, applies joins, commands, leaves and lease ends to `world`, and puts the rest
  /// into `intake` (cleared first). now_ns never goes back.
  ///
  /// A release, undo, redo, reset or consent waits until earlier increments of the same user and
  /// part were applied, because decisions are applied before the increments of a tick. It also
  /// waits for increments that were sent before it and are still under way (Command::after), for at
  /// most after_wait_s.
  void admit(ServerInput input, World& world, std::int64_t now_ns, Intake& intake);

  /// Takes over from another server's inbox: its users keep their ids and count as absent when they
  /// do not ask to join again in time. Call once, before admit().
  void adopt(const std::vector<SeatRecord>& seats, std::int64_t now_ns);
  std::vector<SeatRecord> seats() const;  ///< of all who are present

  /// From now on a join of a new user gets no answer: the client asks again, and joins at the next
  /// leader.
  void put_off_newcomers() { puts_off_newcomers_ = true; }

  const InboxCounters& counters() const { return counters_; }
  const std::vector<UserCounters>& user_counters() const { return user_counters_; }  ///< by index
  std::size_t waiting_increments() const { return waiting_increments_; }
  std::size_t waiting_commands() const { return deferred_.size(); }
  std::uint32_t users_present() const;

 private:
  struct Seat {  ///< the state of one user; seats_[i] is user i + 1
    ClientKey client;
    std::uint64_t nonce = 0;
    bool present = false;
    std::uint64_t left = 0;  ///< number of the departure; 0: never here, or before this server
    std::int64_t awaited_until_ns = 0;  ///< adopted, and has not asked again yet; 0: is there
    IncrementOrder increments;
    std::uint64_t acknowledged = 0;         ///< of the increments
    std::deque<ReceivedIncrement> backlog;  ///< in rising sequence
    std::uint64_t refused_up_to = 0;        ///< behind the backlog: acknowledged when that is empty
    std::uint32_t queued = 0, queued_before = 0;  ///< increments, in this second and the last one
    std::int64_t second_ns = 0;                   ///< when this second began
    SequenceWindow commands;
    double tokens = 0.0;  ///< of the rate bucket
    std::int64_t tokens_at_ns = 0;
    std::uint32_t told = 0;  ///< refusals in this drain
  };
  /// A command or goodbye that waits for increments with a sequence up to `after`: a command until
  /// until_ns also for those that have not come.
  struct DeferredCommand {
    ReceivedCommand received;
    std::uint64_t after = 0;
    std::int64_t until_ns = 0;
  };
  struct DeferredGoodbye {
    UserId user;
    std::uint64_t after = 0;
  };

  Seat* seat_of(UserId user, const ClientKey& client);
  /// The id of the user who has been absent longest; none: all are present.
  UserId longest_gone(const World& world) const;
  UserId first_user_of(const ClientKey& client) const;
  bool take_token(Seat& seat, std::int64_t now_ns);
  /// How many increments this tick may take of that user.
  std::size_t share_of(const Seat& seat, const World& world) const;
  /// Would a grab, an ask or a consent give its taker more parts than a user may hold?
  bool hand_is_full(const World& world, const Command& command) const;
  void renew(World& world, UserId user, std::int64_t now_ns);

  void admit_join(const JoinRequest& request, World& world, std::int64_t now_ns, Intake& intake);
  void admit_command(const ReceivedCommand& received, World& world, std::int64_t now_ns,
                     Intake& intake);
  void carry_out(const Command& command, World& world, std::int64_t now_ns, Intake& intake);
  /// Leases and asks begin with the decision that makes them.
  void note_times(const Decision& decision, std::int64_t now_ns);
  void carry_out_deferred(World& world, std::int64_t now_ns, Intake& intake);
  /// Who sent it, in which order, how fast: what can be said on arrival.
  void receive_increment(const ReceivedIncrement& received, std::int64_t now_ns, Intake& intake);
  /// The same for what is in order now.
  void queue(const ReceivedIncrement& received, std::int64_t now_ns, Intake& intake);
  /// Takes this tick's share from the backlogs, checked against the present holders.
  void take_increments(const World& world, std::int64_t now_ns, Intake& intake);
  /// Takes the first one of the backlog of a user, or refuses it.
  void take_first(UserId user, const World& world, std::int64_t now_ns, Intake& intake);
  bool waits(UserId user, PartId part, std::uint64_t up_to_seq) const;
  /// The same for a command; counts commands that no longer wait.
  bool waits(const DeferredCommand& deferred, std::int64_t now_ns);
  /// Does one about the same part wait already? Then this one waits behind it.
  static bool is_behind(const std::vector<DeferredCommand>& waiting, const Command& command);
  /// What is wrong with a request to join; kNone: nothing.
  Refusal check_join(const JoinRequest& request, const World& world, UserId known,
                     std::string& text) const;
  void end_waiting(World& world, std::int64_t now_ns, Intake& intake);
  void end_asks(World& world, std::int64_t now_ns, Intake& intake);
  Refusal judge(const Increment& increment, const World& world) const;
  void refuse(const Increment& increment, UserId tell, Refusal reason, Intake& intake);
  void depart(const std::vector<LostUser>& lost, bool said_goodbye, World& world, Intake& intake);
  void leave(UserId user, bool said_goodbye, World& world, Intake& intake);
  void end_leases(World& world, std::int64_t now_ns, Intake& intake);
  /// sent_ns 0: no latency can be told from this one.
  void acknowledge(UserId user, std::uint64_t seq, std::int64_t sent_ns, Intake& intake);

  InboxLimits limits_;
  UserCounters& counters_of(UserId user);  ///< shared counters for users who never joined

  InboxCounters counters_;
  std::vector<UserCounters> user_counters_;
  UserCounters strangers_;
  std::vector<Seat> seats_;
  std::vector<std::uint32_t> moving_;     ///< parts that can be held, by index: not all of a scene
  std::vector<std::int64_t> renewed_ns_;  ///< by part index: when its lease was last renewed
  std::vector<std::int64_t> asked_ns_;    ///< by part index: time of the open request for it
  bool puts_off_newcomers_ = false;
  std::uint64_t departures_ = 0;
  std::vector<ReceivedIncrement> ready_;   ///< in order now, of one arrival
  std::size_t waiting_increments_ = 0;     ///< in all backlogs
  std::vector<DeferredCommand> deferred_;  ///< in order of arrival
  std::vector<DeferredGoodbye> goodbyes_;
  std::uint32_t told_strangers_ = 0;
  double session_tokens_ = 0.0;  ///< of the session's rate bucket; full at the first message
  std::optional<std::int64_t> session_tokens_at_ns_;
};

}  // namespace mortise
