#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/messages/event.h"

namespace mortise {

/// What a participant saw of the event stream, short enough to be compared between participants
/// that came and went at different times: a hash over (seq, clash, kind, class) of all events, and
/// one for each whole block of 64 sequence numbers.
class StreamDigest {
 public:
  static constexpr std::uint64_t kBlock = 64;  ///< chosen: a gap costs the rest of one block

  /// Events in order of seq. After a gap the block that it interrupts is dropped.
  void add(const ClashEvent& event);

  std::uint64_t hash() const { return hash_; }  ///< of all, in order
  /// Hash by number of the block; block n holds the events 64 n + 1 to 64 n + 64.
  const std::map<std::uint64_t, std::uint64_t>& blocks() const { return blocks_; }

 private:
  std::uint64_t hash_ = 0, block_hash_ = 0, in_block_ = 0, last_seq_ = 0;
  std::map<std::uint64_t, std::uint64_t> blocks_;
};

/// Whether participants that saw the same blocks saw the same events.
struct StreamComparison {
  std::uint64_t blocks = 0;     ///< seen by two or more
  std::uint64_t differing = 0;  ///< of these
};
StreamComparison compare_streams(
    std::span<const std::map<std::uint64_t, std::uint64_t>> participants);

}  // namespace mortise
