#include "client/known_standing.h"

#include <utility>

namespace mortise {

bool KnownStanding::take(const Snapshot& snapshot) {
  if (has_snapshot_ && snapshot.tick < snapshot_tick_) return false;
  snapshot_tick_ = snapshot.tick;
  has_snapshot_ = true;
  std::vector<Decision> before = std::exchange(decisions_, snapshot.standing);
  std::erase_if(later_, [&](const StandingChange& c) { return c.tick <= snapshot.tick; });
  for (const StandingChange& change : later_) carry_out(change);
  return decisions_ != before;
}

bool KnownStanding::take(const StandingChange& change) {
  if (has_snapshot_ && change.tick <= snapshot_tick_) return false;
  later_.push_back(change);
  carry_out(change);
  return true;
}

void KnownStanding::expect_another_server() {
  snapshot_tick_ = 0;
  has_snapshot_ = false;
  later_.clear();
}

void KnownStanding::carry_out(const StandingChange& change) {
  std::erase(decisions_, change.decision);
  if (change.holds) decisions_.push_back(change.decision);
}

}  // namespace mortise
