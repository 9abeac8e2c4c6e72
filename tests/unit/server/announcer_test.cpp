#include "server/announcer.h"

#include <gtest/gtest.h>

#include <sstream>

namespace mortise {
namespace {

TEST(LiveLine, IsOneShortLineAndNamesTroubleOnlyWhenThereIsSome) {
  SessionPulse pulse;
  pulse.users = 4;
  pulse.clashes_open[3] = 1;
  pulse.clashes_open[2] = 12;
  pulse.clashes_open[1] = 7;
  pulse.tick_p99_us = 2345.6;
  const std::string line = live_line(pulse, 30.0);
  EXPECT_EQ(line, "30.0 s, 4 users | open: 1 real, 12 potential, 7 fake | tick p99 2.3 ms");
  EXPECT_LE(line.size(), 85U);
  pulse.refused = 3;
  pulse.missed_deadlines = 2;
  EXPECT_NE(live_line(pulse, 30.0).find("3 refused | 2 deadlines missed"), std::string::npos);
}

TEST(AddressLines, EndWithTheOneToTakePartBy) {
  std::istringstream written("designer http://h:1/#token=d\nobserver http://h:1/#token=o\n");
  EXPECT_EQ(address_lines(written),
            (std::vector<std::string>{"to look on only:    http://h:1/#token=o",
                                      "open in a browser:  http://h:1/#token=d"}));
}

TEST(AddressLines, NameThePersonsThatTheyAreOf) {
  std::istringstream written("designer ann http://h:1/#token=a\n\n");
  EXPECT_EQ(address_lines(written), std::vector<std::string>{"designer ann http://h:1/#token=a"});
}

}  // namespace
}  // namespace mortise
