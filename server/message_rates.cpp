#include "server/message_rates.h"

#include <algorithm>

namespace mortise {

void MessageRates::begin(UserId user, std::int64_t now_ns) {
  if (user.value > of_user_.size()) of_user_.resize(user.value);
  of_user_[user.value - 1] = {limits_.messages_per_s, now_ns};
}

bool MessageRates::has_room(UserId user, std::int64_t now_ns) {
  const auto refill = [now_ns](Bucket& bucket, double per_s) {
    const double since_s = static_cast<double>(now_ns - bucket.at_ns) * 1e-9;
    bucket = {std::min(per_s, bucket.tokens + since_s * per_s), now_ns};
  };
  if (!of_all_) of_all_ = {limits_.session_messages_per_s, now_ns};
  Bucket& own = of_user_[user.value - 1];
  refill(*of_all_, limits_.session_messages_per_s);
  refill(own, limits_.messages_per_s);
  return own.tokens >= 1.0 && of_all_->tokens >= 1.0;
}

bool MessageRates::take(UserId user, std::int64_t now_ns) {
  if (!has_room(user, now_ns)) return false;
  of_user_[user.value - 1].tokens -= 1.0;
  of_all_->tokens -= 1.0;
  return true;
}

}  // namespace mortise
