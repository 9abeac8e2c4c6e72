#include "server/increment_order.h"

#include <algorithm>

namespace mortise {

void IncrementOrder::hand_out(std::vector<ReceivedIncrement>& ready) {
  while (!held_.empty() && held_.begin()->first == newest_ + 1) {
    newest_ = held_.begin()->first;
    (void)handed_out_.admit(newest_);
    ready.push_back(std::move(held_.begin()->second));
    held_.erase(held_.begin());
  }
}

void IncrementOrder::skip_to(std::uint64_t seq, std::vector<ReceivedIncrement>& ready) {
  hand_out(ready);
  while (newest_ + 1 < seq) {
    const std::uint64_t next = held_.empty() ? seq : std::min(held_.begin()->first, seq);
    if (begun_) lost_ += next - newest_ - 1;
    newest_ = next - 1;
    hand_out(ready);
  }
}

IncrementOrder::Arrival IncrementOrder::receive(const ReceivedIncrement& received,
                                                std::vector<ReceivedIncrement>& ready) {
  const std::uint64_t seq = received.increment.seq;
  if (seq <= newest_) {
    if (received.repeated) return Arrival::kSeen;
    return handed_out_.admit(seq) == Refusal::kDuplicate ? Arrival::kSeen : Arrival::kStale;
  }
  // Below what the sender still keeps nothing will come any more.
  skip_to(received.kept_from == 0 ? seq : received.kept_from, ready);
  begun_ = true;
  if (seq <= newest_ || !held_.emplace(seq, received).second) return Arrival::kSeen;
  repaired_ += received.repeated;
  hand_out(ready);
  if (held_.size() > kMaxKeptIncrements) skip_to(held_.begin()->first, ready);
  return Arrival::kNew;
}

}  // namespace mortise
