#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "common/messages/channel.h"
#include "server/sequence_window.h"

namespace mortise {

/// Restores the order in which a user sent increments, whatever the network loses, duplicates and
/// reorders. An increment behind a gap is held until the sender has repeated what is missing, or
/// says (kept_from) that it cannot. For a sender that never repeats nothing is held. What is in
/// order stays here until it is taken, as far as there is room; what finds none is not received,
/// and its sender repeats it.
class IncrementOrder {
 public:
  enum class Arrival : std::uint8_t { kUnknown = 0, kNew, kSeen, kStale, kNoRoom };

  IncrementOrder() = default;
  /// Of a sender of whom all up to `handled` was handed out, and what came after is sent again.
  static IncrementOrder after(std::uint64_t handled);

  /// kSeen: a repetition; kStale: too late, was given up.
  Arrival receive(const ReceivedIncrement& received);
  /// The next in order, in rising sequence; null: none is here.
  const ReceivedIncrement* next() const { return has_next() ? &held_.begin()->second : nullptr; }
  ReceivedIncrement take_next();  ///< where there is one

  std::uint64_t newest() const { return newest_; }      ///< up to here all was handed out or lost
  std::uint64_t lost() const { return lost_; }          ///< numbered, and never arrived
  std::uint64_t repaired() const { return repaired_; }  ///< arrived only by repetition
  std::size_t held() const { return held_.size(); }     ///< behind a gap, or not taken yet

 private:
  bool has_next() const { return !held_.empty() && held_.begin()->first == newest_ + 1; }
  /// Below `kept_from_` nothing will come any more.
  void skip_what_is_missing();

  std::uint64_t newest_ = 0, lost_ = 0, repaired_ = 0, kept_from_ = 0;
  bool begun_ = false;
  SequenceWindow handed_out_;
  std::map<std::uint64_t, ReceivedIncrement> held_;  ///< by sequence, all above newest_
};

}  // namespace mortise
