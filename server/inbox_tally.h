#pragma once
#include <cstdint>
#include <vector>

#include "server/intake.h"

namespace mortise {

/// Counts for the inbox, for the session and for each user, and sends refusals of increments.
class InboxTally {
 public:
  explicit InboxTally(const InboxLimits& limits) : limits_(limits) {}

  /// Before each drain: allows a few refusals to each user again.
  void begin_drain();
  /// A user has joined. With an id that was taken over, its counts begin at zero.
  void begin(UserId user, bool with_taken_id);

  InboxCounters& all() { return all_; }
  UserCounters& of(UserId user);  ///< shared counters for users who never joined
  /// Sends the refusal to user `tell`, up to the limit of this drain.
  void refuse(const Increment& increment, UserId tell, Refusal reason, Intake& intake);
  /// Would this user be told of another refusal in this drain?
  bool can_tell(UserId user) const {
    return (knows(user) ? told_[user.value - 1] : told_strangers_) < limits_.refusals_told_per_tick;
  }
  void count_refused_command(UserId user);

  const InboxCounters& counters() const { return all_; }
  const std::vector<UserCounters>& by_user() const { return by_user_; }  ///< by index

 private:
  bool knows(UserId user) const { return user && user.value <= by_user_.size(); }

  const InboxLimits& limits_;
  InboxCounters all_;
  std::vector<UserCounters> by_user_;
  UserCounters strangers_;
  std::vector<std::uint32_t> told_;  ///< refusals in this drain, by user index
  std::uint32_t told_strangers_ = 0;
};

}  // namespace mortise
