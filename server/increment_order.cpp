#include "server/increment_order.h"

#include <algorithm>
#include <utility>

namespace mortise {

IncrementOrder IncrementOrder::after(std::uint64_t handled) {
  IncrementOrder order;
  order.newest_ = handled;
  order.begun_ = handled != 0;
  return order;
}

ReceivedIncrement IncrementOrder::take_next() {
  ReceivedIncrement next = std::move(held_.begin()->second);
  held_.erase(held_.begin());
  newest_ = next.increment.seq;
  (void)handed_out_.admit(newest_);
  skip_what_is_missing();
  return next;
}

void IncrementOrder::skip_what_is_missing() {
  const std::uint64_t here = held_.empty() ? kept_from_ : held_.begin()->first;
  const std::uint64_t next = std::min(here, kept_from_);
  if (next <= newest_ + 1) return;
  if (begun_) lost_ += next - newest_ - 1;
  newest_ = next - 1;
}

IncrementOrder::Arrival IncrementOrder::receive(const ReceivedIncrement& received) {
  const std::uint64_t seq = received.increment.seq;
  if (seq <= newest_) {
    if (received.repeated) return Arrival::kSeen;
    return handed_out_.admit(seq) == Refusal::kDuplicate ? Arrival::kSeen : Arrival::kStale;
  }
  kept_from_ = std::max(kept_from_, received.kept_from == 0 ? seq : received.kept_from);
  skip_what_is_missing();
  begun_ = true;
  if (seq <= newest_ || held_.contains(seq)) return Arrival::kSeen;
  if (has_next() && held_.size() >= kMaxKeptIncrements) return Arrival::kNoRoom;
  held_.emplace(seq, received);
  repaired_ += received.repeated;
  // A hole that is never filled.
  if (held_.size() > kMaxKeptIncrements) {
    kept_from_ = std::max(kept_from_, held_.begin()->first);
    skip_what_is_missing();
  }
  return Arrival::kNew;
}

}  // namespace mortise
