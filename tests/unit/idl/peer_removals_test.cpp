#include "idl/peer_removals.h"

#include <gtest/gtest.h>

#include <future>
#include <vector>

namespace mortise {
namespace {

TEST(PeerRemovals, AreCarriedOutInTurnByAnotherThread) {
  PeerRemovals removals;
  std::vector<int> done;
  std::promise<std::thread::id> last;
  for (int i = 0; i < 3; ++i) removals.add([&done, i] { done.push_back(i); });
  removals.add([&] { last.set_value(std::this_thread::get_id()); });
  EXPECT_NE(last.get_future().get(), std::this_thread::get_id());
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2}));
}

TEST(PeerRemovals, WhoStopsWaitsForWhatIsUnderWayAndNothingFollows) {
  PeerRemovals removals;
  std::promise<void> begun, go_on;
  bool ended = false, followed = false;
  removals.add([&] {
    begun.set_value();
    go_on.get_future().wait();
    ended = true;
  });
  removals.add([&] { followed = true; });
  begun.get_future().wait();
  std::thread release([&] {
    while (!removals.stops()) std::this_thread::yield();
    go_on.set_value();
  });
  removals.stop();
  EXPECT_TRUE(ended);
  EXPECT_FALSE(followed);
  removals.add([&] { followed = true; });
  EXPECT_FALSE(followed);
  release.join();
}

}  // namespace
}  // namespace mortise
