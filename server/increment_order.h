#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "common/messages/channel.h"
#include "server/sequence_window.h"

namespace mortise {

/// Restores the order in which a user sent increments, whatever the network loses, duplicates and
/// reorders. An increment behind a gap is held until the sender has repeated what is missing, or
/// says (kept_from) that it cannot. For a sender that never repeats nothing is held.
class IncrementOrder {
 public:
  enum class Arrival : std::uint8_t { kUnknown = 0, kNew, kSeen, kStale };

  /// Appends to `ready` what is in order now, in rising sequence. kSeen: a repetition; kStale: too
  /// late, was given up.
  Arrival receive(const ReceivedIncrement& received, std::vector<ReceivedIncrement>& ready);

  std::uint64_t newest() const { return newest_; }      ///< up to here all was handed out or lost
  std::uint64_t lost() const { return lost_; }          ///< numbered, and never arrived
  std::uint64_t repaired() const { return repaired_; }  ///< arrived only by repetition
  std::size_t held() const { return held_.size(); }     ///< behind a gap

 private:
  void hand_out(std::vector<ReceivedIncrement>& ready);
  void skip_to(std::uint64_t seq, std::vector<ReceivedIncrement>& ready);

  std::uint64_t newest_ = 0, lost_ = 0, repaired_ = 0;
  bool begun_ = false;
  SequenceWindow handed_out_;
  std::map<std::uint64_t, ReceivedIncrement> held_;  ///< by sequence, all above newest_ + 1
};

}  // namespace mortise
