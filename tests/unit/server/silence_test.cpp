#include "server/silence.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

constexpr double kTurn_s = 0.001;

/// How long it has to be silent from now on until that is believed.
double until_believed_s(Silence silence) {
  double waited_s = 0.0;
  for (; !silence.is_believed() && waited_s < 10.0; waited_s += kTurn_s) {
    silence.turn(kTurn_s);
  }
  return waited_s;
}

TEST(Silence, IsBelievedSoonByOneThatRan) {
  Silence silence;
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s, 2 * kTurn_s);
  for (int i = 0; i < 60; ++i) silence.turn(kTurn_s);
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s - 0.06, 2 * kTurn_s);
  silence.heard();
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s, 2 * kTurn_s);
}

TEST(Silence, AfterAStallIsWaitedForAsMuchLonger) {
  for (const double stall_s : {0.06, 0.25, 0.5}) {
    Silence silence;
    silence.turn(stall_s);
    EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s + stall_s - Silence::kTurnCounts_s,
                2 * kTurn_s)
        << stall_s;
  }
  Silence silence;  // a long one, and several together: never longer than kWary_s
  silence.turn(30.0);
  EXPECT_NEAR(until_believed_s(silence), Silence::kWary_s - Silence::kTurnCounts_s, 2 * kTurn_s);
  silence = {};
  for (int i = 0; i < 3; ++i) silence.turn(0.2);
  silence.heard();
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s + 0.6, 2 * kTurn_s);
}

TEST(Silence, ForgetsAStallAfterASecondInWhichItRan) {
  Silence silence;
  silence.turn(0.4);
  for (double ran_s = 0.0; ran_s < Silence::kCalm_s + kTurn_s; ran_s += kTurn_s) {
    silence.turn(kTurn_s);
    silence.heard();
  }
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s, 2 * kTurn_s);
}

// A stall of this process delays the sign of life of one that is there, too.
TEST(Silence, OfOneThatIsThereIsBelievedATurnAfterItIsGoneAndLaterAfterAStall) {
  Silence silence;
  for (double ran_s = 0.0; ran_s < 5.0; ran_s += kTurn_s) {
    silence.turn(kTurn_s);
    silence.present();
  }
  EXPECT_FALSE(silence.is_believed());
  EXPECT_NEAR(until_believed_s(silence), Silence::kSilent_s - Silence::kPresent_s, 2 * kTurn_s);
  silence.turn(0.2);
  EXPECT_FALSE(silence.is_believed());
  EXPECT_GT(until_believed_s(silence), 0.19);
}

}  // namespace
}  // namespace mortise
