#include "idl/tick_watch.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

/// Asks as the heartbeat does, from `from_s` on, with a thread that computes for `share` of the
/// time; says when the answer was no first, or `until_s`.
double silent_from(TickWatch& watch, double from_s, double until_s, double share) {
  for (double now_s = from_s; now_s < until_s; now_s += 0.04)
    if (!watch.advances(now_s, share * now_s)) return now_s;
  return until_s;
}

TEST(TickWatch, BeforeTheFirstTickNobodyIsMissed) {
  TickWatch watch;
  EXPECT_EQ(silent_from(watch, 0.0, 100.0, 0.0), 100.0);
}

TEST(TickWatch, OneThatComesWhenItSaidIsAlive) {
  TickWatch watch;
  for (double now_s = 0.0; now_s < 100.0; now_s += 1.0) {  // a tick a second, and little to do
    watch.progress(now_s, 1.0);
    EXPECT_EQ(silent_from(watch, now_s, now_s + 1.0, 0.001), now_s + 1.0);
  }
}

TEST(TickWatch, OneThatStandsStillIsMissedAfterASecond) {
  for (const double due_s : {0.0, 0.016, 1.0}) {
    TickWatch watch;
    watch.progress(50.0, due_s);
    EXPECT_NEAR(silent_from(watch, 50.0, 100.0, 0.0), 50.0 + due_s + TickWatch::kLate_s, 0.05);
    watch.progress(200.0, 0.0);
    EXPECT_TRUE(watch.advances(200.5, 0.0)) << "it goes on";
  }
}

TEST(TickWatch, OneThatComputedUntilItStoodStillIsMissedAsSoon) {
  TickWatch watch;
  double cpu_s = 0.0, now_s = 0.0;
  for (; now_s < 10.0; now_s += 0.016) {  // busy ticks
    watch.progress(now_s, 0.016);
    EXPECT_TRUE(watch.advances(now_s, cpu_s += 0.012));
  }
  const double stopped_s = now_s;
  while (watch.advances(now_s, cpu_s)) now_s += 0.04;
  EXPECT_LT(now_s - stopped_s, TickWatch::kLate_s + 0.1);
}

TEST(TickWatch, ALongTickIsNoHangUntilItIsForEver) {
  TickWatch watch;
  watch.progress(50.0, 0.0);
  EXPECT_NEAR(silent_from(watch, 50.0, 100.0, 0.5), 50.0 + TickWatch::kLongTick_s, 0.05);
  TickWatch looks_only;  // a loop that waits and looks again
  looks_only.progress(50.0, 0.0);
  EXPECT_NEAR(silent_from(looks_only, 50.0, 100.0, 0.02), 50.0 + TickWatch::kLate_s, 0.05);
}

}  // namespace
}  // namespace mortise
