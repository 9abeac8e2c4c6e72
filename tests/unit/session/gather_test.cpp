#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/base/ranges.h"
#include "common/math/rotation.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

struct GatherTest : ::testing::Test {
  SessionBuilder session;
  PartId wall = session.add("wall", cube_mesh(1), at(100, 0, 0), false);
  PartId peg = session.add("peg", cube_mesh(1), at(0, 0, 0), true);
  PartId pin = session.add("pin", cube_mesh(1), at(0, 50, 0), true);
  UserId ada = session.join("ada");
  UserId bob = session.join("bob");
  Scratch scratch;

  void SetUp() override {
    session.world.max_jump_mm = 50.0;
    session.grab(ada, peg);
  }
  // One increment; the reason for which it was refused, or none.
  Refusal refusal(const Increment& increment) {
    const Pose before = session.pose(peg);
    const StepReport report = play_tick(session.world, {increment}, scratch);
    EXPECT_EQ(report.counters.increments.in, 1U);
    if (report.refused.empty()) return Refusal::kNone;
    EXPECT_EQ(report.refused.size(), 1U);
    EXPECT_EQ(report.refused[0].seq, increment.seq);
    EXPECT_EQ(report.counters.increments.out, 0U);
    EXPECT_EQ(report.counters.refused[static_cast<std::size_t>(report.refused[0].reason)], 1U);
    EXPECT_TRUE(identical(before, session.pose(peg)));
    return report.refused[0].reason;
  }
};

TEST_F(GatherTest, EveryReasonToRefuse) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal({UserId{7}, peg, 1, Vec3(1, 0, 0)}), Refusal::kUnknownUser);
  EXPECT_EQ(refusal({UserId{}, peg, 1, Vec3(1, 0, 0)}), Refusal::kUnknownUser);
  EXPECT_EQ(refusal({ada, PartId{7}, 1, Vec3(1, 0, 0)}), Refusal::kUnknownPart);
  EXPECT_EQ(refusal({ada, wall, 1, Vec3(1, 0, 0)}), Refusal::kPartIsStatic);
  EXPECT_EQ(refusal({ada, pin, 1, Vec3(1, 0, 0)}), Refusal::kNotHolder);
  EXPECT_EQ(refusal({bob, peg, 1, Vec3(1, 0, 0)}), Refusal::kNotHolder);
  EXPECT_EQ(refusal({ada, peg, 1, Vec3(nan, 0, 0)}), Refusal::kNotFinite);
  EXPECT_EQ(refusal({ada, peg, 1, Vec3(0, 0, 0), Vec3(0, inf, 0)}), Refusal::kNotFinite);
  EXPECT_EQ(refusal({ada, peg, 1, Vec3(0, 0, 0), Vec3(0, 0, 3.2)}), Refusal::kRotationTooLarge);
  EXPECT_EQ(refusal({ada, peg, 1, Vec3(40, 40, 0)}), Refusal::kJumpTooLarge);
  EXPECT_EQ(refusal({ada, peg, 5, Vec3(1, 0, 0)}), Refusal::kNone);
  EXPECT_EQ(refusal({ada, peg, 5, Vec3(1, 0, 0)}), Refusal::kDuplicate);
  EXPECT_EQ(refusal({ada, peg, 4, Vec3(1, 0, 0)}), Refusal::kStale);
  EXPECT_EQ(refusal({ada, peg, 9, Vec3(1, 0, 0)}), Refusal::kNone);  // gaps are losses
  EXPECT_EQ(session.pose(peg).p, Vec3(2, 0, 0));
}

// Step by step out of the world: poses beyond the range of lengths cannot come to be.
TEST_F(GatherTest, NobodyLeavesTheWorld) {
  session.world.max_jump_mm = kLongest_mm;
  EXPECT_EQ(refusal({ada, peg, 1, Vec3(0.9 * kLongest_mm, 0, 0)}), Refusal::kNone);
  EXPECT_EQ(refusal({ada, peg, 2, Vec3(0.9 * kLongest_mm, 0, 0)}), Refusal::kJumpTooLarge);
  const StepReport report = play_tick(
      session.world,
      {{ada, peg, 3, Vec3(0, 0.9 * kLongest_mm, 0)}, {ada, peg, 4, Vec3(0, kLongest_mm, 0)}},
      scratch);
  EXPECT_EQ(report.counters.increments.out, 1U);
  EXPECT_EQ(refusal({ada, peg, 5, Vec3(-1, 0, 0)}), Refusal::kNone);
}

TEST_F(GatherTest, RepeatInTheSameTickIsDropped) {
  const Increment one = session.push(ada, peg, Vec3(1, 0, 0));
  const StepReport report = play_tick(session.world, {one, one, one}, scratch);
  EXPECT_EQ(report.counters.increments.out, 1U);
  EXPECT_EQ(report.counters.refused[static_cast<std::size_t>(Refusal::kDuplicate)], 2U);
  EXPECT_EQ(session.pose(peg).p, Vec3(1, 0, 0));
}

// Eq. (1): the increment acts on the left, in world axes. A part that is already turned moves along
// the world's axis, not its own.
TEST_F(GatherTest, IncrementsActOnTheLeftInOrderOfArrival) {
  const Vec3 turn_z(0, 0, 0.5 * M_PI), turn_x(0.5 * M_PI, 0, 0);
  const StepReport report = play_tick(session.world,
                                      {session.push(ada, peg, Vec3(1, 0, 0), turn_z),
                                       session.push(ada, peg, Vec3(1, 0, 0), turn_x)},
                                      scratch);
  EXPECT_EQ(report.counters.moves.out, 1U);
  EXPECT_TRUE(session.pose(peg).p.isApprox(Vec3(2, 0, 0), 1e-14));
  const Quat expected = rotation_exp(turn_x) * rotation_exp(turn_z);
  EXPECT_LT(session.pose(peg).q.angularDistance(expected), 1e-14);
  EXPECT_GT(session.pose(peg).q.angularDistance(rotation_exp(turn_z) * rotation_exp(turn_x)), 0.5);
}

TEST_F(GatherTest, RotationTurnsAboutTheReferencePoint) {
  const PartId off =
      session.add("off", box_mesh(Vec3(9, 0, 0), Vec3(11, 2, 2)), at(0, 0, 30), true);
  session.grab(ada, off);
  const Vec3 center_P = session.world.find(off)->solid->sphere().center_mm;
  const Vec3 before = session.pose(off) * center_P;
  play_tick(session.world, {session.push(ada, off, Vec3(0, 0, 1), Vec3(0.3, 0.2, 0.1))}, scratch);
  EXPECT_LT((session.pose(off) * center_P - before - Vec3(0, 0, 1)).norm(), 1e-13);
}

TEST_F(GatherTest, MoreThanHalfATurnInOneTickIsRefused) {
  const StepReport report = play_tick(session.world,
                                      {session.push(ada, peg, Vec3::Zero(), Vec3(0, 0, 2)),
                                       session.push(ada, peg, Vec3::Zero(), Vec3(0, 0, 2))},
                                      scratch);
  EXPECT_EQ(report.counters.increments.out, 1U);
  EXPECT_EQ(report.counters.refused[static_cast<std::size_t>(Refusal::kRotationTooLarge)], 1U);
}

TEST_F(GatherTest, WhatCancelsOutOrCannotBeFeltIsNoMove) {
  StepReport report = play_tick(
      session.world,
      {session.push(ada, peg, Vec3(1, 0, 0)), session.push(ada, peg, Vec3(-1, 0, 0))}, scratch);
  EXPECT_EQ(report.counters.moves.in, 1U);
  EXPECT_EQ(report.counters.moves.out, 0U);
  EXPECT_EQ(report.counters.moves_below_rounding, 1U);
  EXPECT_TRUE(report.moved.empty());
  report = play_tick(session.world, {session.push(ada, peg, Vec3(1e-17, 0, 0))}, scratch);
  EXPECT_EQ(report.counters.moves_below_rounding, 1U);
}

}  // namespace
}  // namespace mortise
