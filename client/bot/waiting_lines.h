#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"

namespace mortise {

/// Pairs that have waited for their verdict for more than 0.5 s: each told once, in words, and
/// again only after a pulse in which it did not wait.
class WaitingLines {
 public:
  explicit WaitingLines(bool quiet) : quiet_(quiet) {}
  /// What there is to tell after this pulse; nothing when quiet.
  std::vector<std::string> after_pulse(const SessionPulse& pulse,
                                       const std::map<PartId, KnownPart>& parts,
                                       double tick_rate_hz);

 private:
  struct Wait {
    double ticks = 0.0;  ///< in this pulse and those before it in a row
    bool told = false;
  };
  bool quiet_;
  std::map<std::pair<PartId, PartId>, Wait> waits_;
};

}  // namespace mortise
