#include "client/bot/event_delay.h"

namespace mortise {
namespace {

constexpr std::size_t kMostKept = 1 << 14;  // acknowledgements: some seconds of many users
constexpr std::int64_t kPatience_ns = 2'000'000'000;  // for the acknowledgement of an event's tick

}  // namespace

std::vector<double> EventDelay::add(const ClientUpdate& update, const Client& client) {
  for (const SeenAck& ack : update.acks) {
    if (ack.sent_ns == 0) continue;
    const Key key{ack.user, ack.tick};
    if (sent_ns_.emplace(key, ack.sent_ns).second) order_.push_back(key);
  }
  for (; order_.size() > kMostKept; order_.pop_front()) sent_ns_.erase(order_.front());
  for (const ClashEvent& event : update.events) {
    for (LocalUser user = 0; user < client.user_count(); ++user) {
      if (event.user && client.user_id(user) == event.user) {
        waiting_.push_back({{user, event.tick}, update.at_ns});
      }
    }
  }
  std::vector<double> delays_ms;
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    const auto sent = sent_ns_.find(waiting.key);
    if (sent == sent_ns_.end()) {
      const bool given_up = update.at_ns - waiting.seen_ns > kPatience_ns;
      unmatched_ += given_up ? 1 : 0;
      return given_up;
    }
    delays_ms.push_back(static_cast<double>(waiting.seen_ns - sent->second) * 1e-6);
    return true;
  });
  return delays_ms;
}

}  // namespace mortise
