#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/world/world.h"
#include "server/command_queue.h"
#include "server/inbox_tally.h"
#include "server/increment_admission.h"
#include "server/intake.h"
#include "server/leases.h"
#include "server/message_rates.h"
#include "server/tick_bytes.h"

namespace mortise {

/// Checks and orders what users send before the tick works on it: who may send for which user, in
/// which order, how fast, about which part, and how long a user keeps a part. Many senders, read by
/// the tick thread only. Has no clock: the time is passed in.
class Inbox {
 public:
  /// This part of the seats goes to participants that have none yet: one that takes all it gets
  /// keeps nobody else out.
  static constexpr std::uint32_t kKeptForOthers = 16;

  explicit Inbox(const InboxLimits& limits) : limits_(limits) {}
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  /// Checks `input`, applies joins, commands, leaves and lease ends to `world`, and puts the rest
  /// into `intake` (cleared first). now_ns never goes back.
  void admit(ServerInput input, World& world, std::int64_t now_ns, Intake& intake);

  /// Takes over from another server's inbox: its users keep their ids and count as absent when they
  /// do not ask to join again in time. Call once, before admit().
  void adopt(const std::vector<SeatRecord>& seats, std::int64_t now_ns);
  std::vector<SeatRecord> seats() const;  ///< of all who are present
  Uploads& uploads() { return uploads_; }

  /// From now on a join of a new user gets no answer: the client asks again, and joins at the next
  /// leader.
  void put_off_newcomers() { puts_off_newcomers_ = true; }

  const InboxCounters& counters() const { return tally_.counters(); }
  const std::vector<UserCounters>& user_counters() const { return tally_.by_user(); }  ///< by index
  std::size_t waiting_increments() const { return increments_.waiting(); }
  std::size_t waiting_commands() const { return commands_.waiting(); }
  std::uint32_t users_present() const;

 private:
  struct Seat {  ///< of one user; seats_[i] is user i + 1
    ClientKey client;
    std::uint64_t nonce = 0;
    bool present = false;
    std::uint64_t left = 0;  ///< number of the departure; 0: never here, or before this server
    std::int64_t awaited_until_ns = 0;  ///< adopted, and has not asked again yet; 0: is there
  };
  /// A leave that waits for increments with a sequence up to `after`.
  struct DeferredGoodbye {
    UserId user;
    std::uint64_t after = 0;
  };

  bool is_present(UserId user) const {
    return user && user.value <= seats_.size() && seats_[user.value - 1].present;
  }
  /// Is this a present user of the client? Counts users of other clients.
  bool speaks_for(const ClientKey& client, UserId user);
  UserId first_user_of(const ClientKey& client) const;
  /// Users in the session beyond which this participant gets no further one.
  std::uint32_t seats_for(const ClientKey& client) const;
  UserId user_who_asked(const JoinRequest& request) const;
  /// The id of the user who has been absent longest; none: all are present.
  UserId longest_gone(const World& world) const;
  void sit_down(UserId user, const Seat& seat, bool with_taken_id, std::int64_t now_ns);

  void admit_join(const JoinRequest& request, World& world, std::int64_t now_ns, Intake& intake);
  void admit_increment(const ReceivedIncrement& received, std::int64_t now_ns, Intake& intake);
  void admit_command(const ReceivedCommand& received, World& world, std::int64_t now_ns,
                     Intake& intake);
  void depart(const std::vector<LostUser>& lost, bool said_goodbye, World& world, Intake& intake);
  void say_goodbye(UserId user, World& world, Intake& intake);
  void leave(UserId user, bool said_goodbye, World& world, Intake& intake);
  void say_waiting_goodbyes(World& world, Intake& intake);
  void end_waiting(World& world, std::int64_t now_ns, Intake& intake);
  void end_leases(World& world, std::int64_t now_ns, Intake& intake);
  static void decide(const Decision& decision, World& world, Intake& intake);

  const InboxLimits limits_;
  InboxTally tally_{limits_};
  MessageRates rates_{limits_};
  Leases leases_;
  IncrementAdmission increments_{limits_, tally_, rates_, leases_};
  Uploads uploads_{limits_};
  CommandQueue commands_{limits_, tally_, rates_, leases_, increments_, uploads_};
  std::vector<Seat> seats_;
  std::vector<DeferredGoodbye> goodbyes_;
  bool puts_off_newcomers_ = false;
  std::uint64_t departures_ = 0;
};

}  // namespace mortise
