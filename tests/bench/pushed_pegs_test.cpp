// However many push at once, nobody who provably leaves or slides waits for the others.
#include "tests/bench/pushed_pegs.h"

#include <gtest/gtest.h>

namespace mortise::bench {
namespace {

TEST(PushedPegs, WhoIsPushedAwayFromTheWallGoes) {
  const Shaken shaken = shake_all({"1 mm clearance", 19.0, ""}, 64, 20);
  EXPECT_EQ(shaken.carried_out, shaken.away);
}

TEST(PushedPegs, SixtyFourGoAsFarAsOne) {
  for (const char* policy : {"stop", "slide"}) {
    const Fit fit{"0.1 mm clearance", 19.9, ""};
    const Pushed one = push_all(fit, 1, policy, 20), all = push_all(fit, 64, policy, 20);
    EXPECT_GT(all.mm_a_tick, 0.9 * one.mm_a_tick) << policy;
    EXPECT_GT(all.least_mm_a_tick, 0.5 * one.mm_a_tick) << policy;
  }
}

}  // namespace
}  // namespace mortise::bench
