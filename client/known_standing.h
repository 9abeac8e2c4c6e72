#pragma once
#include <cstdint>
#include <vector>

#include "common/messages/scene.h"

namespace mortise {

/// The decisions that hold, as the session tells them: all of them with a snapshot, then what
/// changes. Snapshots and changes come by ways of their own, so that either may overtake the other.
class KnownStanding {
 public:
  const std::vector<Decision>& decisions() const { return decisions_; }
  /// Both say whether decisions() may be another list.
  bool take(const Snapshot& snapshot);
  bool take(const StandingChange& change);
  /// What comes next is of another server, whose ticks count anew. decisions() stays until then.
  void expect_another_server();

 private:
  void carry_out(const StandingChange& change);

  std::vector<Decision> decisions_;
  std::uint64_t snapshot_tick_ = 0;
  bool has_snapshot_ = false;
  std::vector<StandingChange> later_;  ///< changes that are not in the snapshot
};

}  // namespace mortise
