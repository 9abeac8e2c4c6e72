#pragma once
#include <cstdint>

#include "common/messages/command.h"

namespace mortise {

/// The sequence numbers seen, with a memory of 64: distinguishes a repetition from a late arrival.
class SequenceWindow {
 public:
  /// kNone: new and newest. kDuplicate: seen. kStale: older than the newest, whether lost before or
  /// not; also 0.
  Refusal admit(std::uint64_t seq);
  std::uint64_t newest() const { return newest_; }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t seen_ = 0;  ///< bit k: newest - k was seen
};

}  // namespace mortise
