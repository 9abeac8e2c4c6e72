#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "common/messages/channel.h"
#include "server/sequence_window.h"

namespace mortise {

/// Puts the increments of one user into the order in which they were sent, however the network
/// loses, doubles and overtakes them: what comes beyond a hole is held until the sender has filled
/// the hole by repetition, or says (kept_from) that it cannot. A sender that never repeats loses
/// what the network loses, and nobody waits for it.
class IncrementOrder {
 public:
  enum class Arrival : std::uint8_t { kUnknown = 0, kNew, kSeen, kStale };

  /// Appends to `ready` what is in order now, in rising sequence. kSeen: came before; kStale: late,
  /// was given up.
  Arrival receive(const ReceivedIncrement& received, std::vector<ReceivedIncrement>& ready);

  std::uint64_t newest() const { return newest_; }      ///< up to here all was handed out or lost
  std::uint64_t lost() const { return lost_; }          ///< numbered, and not even came repeated
  std::uint64_t repaired() const { return repaired_; }  ///< came only by repetition
  std::size_t held() const { return held_.size(); }     ///< beyond a hole

 private:
  void hand_out(std::vector<ReceivedIncrement>& ready);
  void skip_to(std::uint64_t seq, std::vector<ReceivedIncrement>& ready);

  std::uint64_t newest_ = 0, lost_ = 0, repaired_ = 0;
  bool begun_ = false;
  SequenceWindow handed_out_;
  std::map<std::uint64_t, ReceivedIncrement> held_;  ///< by sequence, all above newest_ + 1
};

}  // namespace mortise
