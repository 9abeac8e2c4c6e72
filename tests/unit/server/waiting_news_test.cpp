#include "server/waiting_news.h"

#include <gtest/gtest.h>

#include "tests/unit/server/small_world.h"

namespace mortise::testing {
namespace {

class WaitingNewsTest : public ::testing::Test {
 protected:
  WaitingNewsTest() { world_.tick_rate_hz = 60.0; }
  // What is told in so many ticks with these pairs.
  std::vector<std::string> play(int ticks, const std::vector<UnexaminedPair>& pairs) {
    std::vector<std::string> told;
    for (int i = 0; i < ticks; ++i) {
      StepReport report;
      report.tick = ++tick_;
      report.unexamined = pairs;
      if (std::string text = news_.after_tick(report, world_); !text.empty()) told.push_back(text);
    }
    return told;
  }
  World world_ = small_world();
  WaitingNews news_;
  std::uint64_t tick_ = 100;
};

const UnexaminedPair kRedWaits{kWall, kRed, Unexamined::kWaitsForDepth};
const UnexaminedPair kBlueWaits{kWall, kBlue, Unexamined::kWaitsForContact};

TEST_F(WaitingNewsTest, TellsOnceAfterMoreThanHalfASecond) {
  EXPECT_TRUE(play(31, {kRedWaits}).empty());  // 30 ticks after the first: 0.5 s, not more
  EXPECT_EQ(play(600, {kRedWaits}),
            (std::vector<std::string>{"wall × red waits for its turn, until its depth is worked "
                                      "out; no pair is reported as clear before it is judged"}));
}

TEST_F(WaitingNewsTest, TellsAgainOnlyAfterNothingHasWaited) {
  EXPECT_EQ(play(40, {kRedWaits}).size(), 1U);
  EXPECT_TRUE(play(100, {kBlueWaits}).empty());  // something has waited all the time
  EXPECT_TRUE(play(1, {}).empty());
  EXPECT_EQ(play(40, {kRedWaits}).size(), 1U);
}

TEST_F(WaitingNewsTest, IsSilentOfPairsOfWhichNoneWaitsLong) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(play(20, {kRedWaits}).empty());
    EXPECT_TRUE(play(20, {kBlueWaits}).empty());
  }
}

TEST_F(WaitingNewsTest, NamesTheLongestAndCountsTheOthers) {
  EXPECT_TRUE(play(20, {kBlueWaits}).empty());
  const std::vector<std::string> told = play(20, {kRedWaits, kBlueWaits});
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].starts_with("wall × blue waits for its turn to be searched for contact"));
  EXPECT_NE(told[0].find(", and one other pair waits;"), std::string::npos);
}

}  // namespace
}  // namespace mortise::testing
