#pragma once
#include <cstdint>
#include <deque>

#include "common/messages/channel.h"

namespace mortise {

/// The increments of one user that the server has not acknowledged yet. The next datagram repeats
/// them; without a next one they are sent again after a while. So a lost datagram costs one sending
/// period and delays only its own content.
class Unacknowledged {
 public:
  /// The batch to send now: the new one, and before it some of the others.
  IncrementBatch add(const SentIncrement& sent, std::int64_t now_ns);
  /// The same without a new one.
  IncrementBatch repeat(std::int64_t now_ns);

  /// All up to seq arrived.
  void acknowledge(std::uint64_t seq);
  /// Gives up everything: another server does not know the user's parts.
  void clear();

  bool empty() const { return kept_.empty(); }
  std::uint64_t newest() const {  ///< sequence; 0: none is kept
    return kept_.empty() ? 0 : kept_.back().increment.seq;
  }
  std::int64_t last_sent_ns() const { return last_sent_ns_; }
  std::uint64_t repeated() const { return repeated_; }
  std::uint64_t given_up() const { return given_up_; }
  std::uint64_t given_up_to() const { return given_up_to_; }  ///< sequence of the last of them

 private:
  IncrementBatch batch(std::uint64_t fresh_from, std::int64_t now_ns);

  std::deque<SentIncrement> kept_;  ///< rising, without gap
  std::uint64_t next_older_ = 0;    ///< sequence of the next one to repeat
  std::int64_t last_sent_ns_ = 0;
  std::uint64_t repeated_ = 0, given_up_ = 0, given_up_to_ = 0;
};

}  // namespace mortise
