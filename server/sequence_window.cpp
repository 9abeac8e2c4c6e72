#include "server/sequence_window.h"

namespace mortise {

Refusal SequenceWindow::admit(std::uint64_t seq) {
  if (seq > newest_) {
    const std::uint64_t step = seq - newest_;
    seen_ = step < 64 ? (seen_ << step) | 1U : 1U;
    newest_ = seq;
    return Refusal::kNone;
  }
  const std::uint64_t age = newest_ - seq;
  if (seq == 0 || age >= 64) return Refusal::kStale;
  const std::uint64_t bit = std::uint64_t{1} << age;
  const bool repeated = (seen_ & bit) != 0;
  seen_ |= bit;
  return repeated ? Refusal::kDuplicate : Refusal::kStale;
}

}  // namespace mortise
