#include "server/announcer.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(LiveLine, IsOneShortLineAndNamesTroubleOnlyWhenThereIsSome) {
  SessionPulse pulse;
  pulse.tick = 1800;
  pulse.users = 4;
  pulse.clashes_open[3] = 1;
  pulse.clashes_open[2] = 12;
  pulse.clashes_open[1] = 7;
  pulse.tick_p99_us = 2345.6;
  const std::string line = live_line(pulse, 30.0);
  EXPECT_EQ(line,
            "30.0 s, tick 1800, 4 users | open: 1 real, 12 potential, 7 fake | tick p99 2.3 ms");
  EXPECT_LE(line.size(), 85U);
  pulse.refused = 3;
  pulse.missed_deadlines = 2;
  EXPECT_NE(live_line(pulse, 30.0).find("3 refused | 2 deadlines missed"), std::string::npos);
}

}  // namespace
}  // namespace mortise
