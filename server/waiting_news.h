#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "common/messages/report.h"
#include "common/session/world/world.h"

namespace mortise {

/// A pair that has had no verdict for longer is told of.
inline constexpr double kTellWaiting_s = 0.5;

/// Pairs that wait for their verdict: told once, in words, and again only after a tick in which no
/// pair has waited.
class WaitingNews {
 public:
  /// Empty: nothing to tell after this tick.
  std::string after_tick(const StepReport& report, const World& world);

 private:
  std::map<std::pair<PartId, PartId>, std::uint64_t> since_tick_;  ///< of pairs that wait now
  bool told_ = false;
};

}  // namespace mortise
