#include "server/inbox_tally.h"

#include <algorithm>

namespace mortise {

void InboxTally::begin_drain() {
  std::fill(told_.begin(), told_.end(), 0u);
  told_strangers_ = 0;
}

void InboxTally::begin(UserId user, bool with_taken_id) {
  if (!knows(user)) {
    by_user_.resize(user.value);
    told_.resize(user.value);
  }
  if (with_taken_id) of(user) = {};
  told_[user.value - 1] = 0;
}

UserCounters& InboxTally::of(UserId user) {
  return knows(user) ? by_user_[user.value - 1] : strangers_;
}

void InboxTally::refuse(const Increment& increment, UserId tell, Refusal reason, Intake& intake) {
  ++all_.refused[static_cast<std::size_t>(reason)];
  ++of(tell).refused;
  if (!can_tell(tell)) {
    ++all_.refusals_untold;
    return;
  }
  ++(knows(tell) ? told_[tell.value - 1] : told_strangers_);
  intake.refused.push_back({tell, increment.part, increment.seq, reason});
}

void InboxTally::count_refused_command(UserId user) {
  ++all_.commands_refused;
  ++of(user).commands_refused;
}

}  // namespace mortise
