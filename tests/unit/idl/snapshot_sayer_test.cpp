#include "idl/snapshot_sayer.h"

#include <gtest/gtest.h>

#include <future>
#include <vector>

namespace mortise {
namespace {

Snapshot of_tick(std::uint64_t tick) {
  Snapshot snapshot;
  snapshot.tick = tick;
  return snapshot;
}

// A tick goes on while an earlier snapshot is still being said, and of those that wait meanwhile
// the last counts.
TEST(SnapshotSayer, NobodyWaitsForItAndTheLastCounts) {
  std::promise<void> begun, go_on;
  std::vector<std::uint64_t> said;
  std::thread::id by;
  SnapshotSayer sayer([&](const Snapshot& snapshot) {
    by = std::this_thread::get_id();
    said.push_back(snapshot.tick);
    if (said.size() > 1) return;
    begun.set_value();
    go_on.get_future().wait();
  });
  sayer.add(of_tick(1));
  begun.get_future().wait();
  for (const std::uint64_t tick : {2, 3, 4}) sayer.add(of_tick(tick));
  go_on.set_value();
  sayer.stop();
  EXPECT_EQ(said, (std::vector<std::uint64_t>{1, 4}));
  EXPECT_NE(by, std::this_thread::get_id());
  sayer.add(of_tick(5));
  EXPECT_EQ(said.size(), 2U);
}

}  // namespace
}  // namespace mortise
