#include "client/unacknowledged.h"

#include <algorithm>

namespace mortise {

IncrementBatch Unacknowledged::add(const SentIncrement& sent, std::int64_t now_ns) {
  if (kept_.size() == kMaxKeptIncrements) {
    given_up_to_ = kept_.front().increment.seq;
    kept_.pop_front();
    ++given_up_;
  }
  kept_.push_back(sent);
  return batch(sent.increment.seq, now_ns);
}

IncrementBatch Unacknowledged::repeat(std::int64_t now_ns) {
  return batch(kept_.empty() ? 0 : kept_.back().increment.seq + 1, now_ns);
}

IncrementBatch Unacknowledged::batch(std::uint64_t fresh_from, std::int64_t now_ns) {
  IncrementBatch batch;
  batch.fresh_from = fresh_from;
  last_sent_ns_ = now_ns;
  if (kept_.empty()) return batch;
  batch.kept_from = kept_.front().increment.seq;
  // The newest are those whose datagrams may just be lost. Of what is older, if there is more, each
  // datagram carries the next few in turn, so that a long hole is filled as fast as a hand moves.
  constexpr std::size_t kNewest = kMaxBatchIncrements / 2;
  std::size_t older = kept_.size() - std::min(kept_.size(), kNewest);
  const std::size_t newest = older;
  std::size_t first = 0;
  if (older > kMaxBatchIncrements - kNewest) {
    if (next_older_ < batch.kept_from || next_older_ - batch.kept_from >= older) {
      next_older_ = batch.kept_from;
    }
    first = next_older_ - batch.kept_from;
    older = std::min(older - first, kMaxBatchIncrements - kNewest);
    next_older_ += older;
  }
  const auto take = [&](std::size_t from, std::size_t count) {
    for (std::size_t i = from; i < from + count; ++i) {
      batch.increments.push_back(kept_[i]);
      repeated_ += kept_[i].increment.seq < fresh_from;
    }
  };
  take(first, older);
  take(newest, kept_.size() - newest);
  return batch;
}

void Unacknowledged::acknowledge(std::uint64_t seq) {
  while (!kept_.empty() && kept_.front().increment.seq <= seq) kept_.pop_front();
}

void Unacknowledged::clear() {
  given_up_ += kept_.size();
  given_up_to_ = std::max(given_up_to_, newest());
  kept_.clear();
}

}  // namespace mortise
