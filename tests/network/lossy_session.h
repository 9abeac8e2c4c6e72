#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/base/nearest_rank.h"
#include "common/base/result.h"
#include "common/messages/event.h"
#include "server/inbox.h"
#include "tests/network/knowledge.h"
#include "tests/network/lossy_link.h"

namespace mortise::test {

/// What a participant is told of an event, to compare streams.
struct SeenEvent {
  std::uint64_t seq = 0;
  ClashId clash;
  ClashEvent::Kind kind = ClashEvent::Kind::kUnknown;
  bool operator==(const SeenEvent&) const = default;
};

/// Two designers on one side of a bad link push their cubes into a wall and pull them out again, 60
/// times a second; the real inbox and tick loop on the other side.
struct LossyRun {
  static constexpr int kUsers = 2;
  std::vector<double> took_s;  ///< from sending to the end of the tick that applied it, rising
  double target_s = 0.0;       ///< for the 99th percentile: twice the way and a tick
  std::uint64_t sent = 0, given_up = 0, resyncs = 0;
  bool agreed = false;  ///< all that was sent came, and all that came of it is known to all
  std::vector<SeenEvent> events;
  Knowledge known;  ///< to the server at the end
  std::array<std::vector<SeenEvent>, kUsers> seen_events;
  std::array<Knowledge, kUsers> seen;
  InboxCounters inbox;
  double missed = 0.0;                  ///< share of deadlines
  std::uint64_t carried = 0, lost = 0;  ///< IP packets

  double percentile_ms(double p) const { return 1e3 * quantile_of_sorted(took_s, p); }
};

/// Fails in one line where no such link can be made, or nobody joined across it.
Result<LossyRun> play_across(const LinkSettings& settings, double seconds);

}  // namespace mortise::test
