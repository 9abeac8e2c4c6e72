// Which decisions hold, and what a session tells of that as it changes.
#include "common/session/world/standing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/effort.h"
#include "tests/unit/session/three_people.h"

namespace mortise {
namespace {

using Kind = Decision::Kind;

struct StandingTest : PeopleTest {
  /// Ada holds the peg on a constraint, and bob asks for it.
  void SetUp() override {
    ask(ada, CommandKind::kGrab, peg);
    session.world.guides.push_back(
        {ConstraintId{1}, ada, {ConstraintKind::kCoplanar, {peg, "a"}, {wall, "b"}}, {}});
    ask(bob, CommandKind::kAskHandOver, peg);
    before = standing_decisions(session.world);
    ASSERT_EQ(before.size(), 2u);
    EXPECT_EQ(before[0].kind, Kind::kAskHandOver);
    EXPECT_EQ(before[1].kind, Kind::kAddConstraint);
    EXPECT_EQ(before[1].details.constraint_id, ConstraintId{1});
  }
  std::vector<StandingChange> changes() const {
    return standing_changes(before, standing_decisions(session.world), 7);
  }

  Decision by_ada(Decision::Kind kind, PartId part = {}) const { return {kind, ada, part, {}}; }

  std::vector<Decision> before;
};

TEST_F(StandingTest, NothingHoldsOfAPartThatWasLetGo) {
  Decision release = by_ada(Kind::kRelease, peg), group_release = by_ada(Kind::kRelease);
  group_release.details.parts = {peg};
  Decision hand_over = by_ada(Kind::kHandOver, peg);
  hand_over.details.other_user = bob;
  const World world = session.world;
  for (const Decision& end :
       {release, group_release, by_ada(Kind::kLeave), by_ada(Kind::kLivelinessLost),
        by_ada(Kind::kLeaseEnd, peg), hand_over}) {
    session.world = world;
    apply_decision(session.world, end);
    EXPECT_TRUE(standing_decisions(session.world).empty()) << static_cast<int>(end.kind);
    const std::vector<StandingChange> told = changes();
    ASSERT_EQ(told.size(), 2u) << static_cast<int>(end.kind);
    for (const StandingChange& change : told) {
      EXPECT_FALSE(change.holds);
      EXPECT_EQ(change.tick, 7u);
      EXPECT_NE(std::ranges::find(before, change.decision), before.end());
    }
  }
}

// Without a list it is known whether the list has changed: whatever is decided, in any order.
TEST_F(StandingTest, WhetherItChangedIsWhatTheListSays) {
  for (const PartId part : {wall, peg}) {
    Decision fit{Kind::kSetTolerance, {}, peg, {}};
    fit.details.other_part = wall;
    fit.details.feature = part == wall ? "shaft" : "journal";
    fit.details.other_feature = "bore";
    session.world.declared.push_back(fit);
  }
  std::mt19937 draw(7);
  int same = 0, other = 0;
  for (int i = 0; i < test::effort(400); ++i) {
    before = standing_decisions(session.world);
    EXPECT_TRUE(are_standing(session.world, before));
    Decision next = by_ada(Kind::kSetExclusion, draw() % 2 == 0 ? peg : wall);
    next.details.other_part = next.part == peg ? wall : peg;
    next.details.text = draw() % 2 == 0 ? "glued" : "welded";
    switch (draw() % 6) {
      case 0:
        next.kind = Kind::kDropExclusion;
        break;
      case 1:
        next.kind = Kind::kSetTolerance;
        next.details.feature = next.part == peg ? "shaft" : "bore";
        next.details.other_feature = next.part == peg ? "bore" : "shaft";
        session.world.standing.push_back(next);
        break;
      case 2:
        next = by_ada(Kind::kRelease, peg);
        break;
      case 3:
        next = by_ada(Kind::kGrab, peg);
        break;
      case 4:
        session.world.find(wall)->present = draw() % 2 == 0;
        break;
      default:
        break;
    }
    if (next.kind != Kind::kSetTolerance) apply_decision(session.world, next);
    const bool stays = standing_decisions(session.world) == before;
    EXPECT_EQ(are_standing(session.world, before), stays) << i;
    ++(stays ? same : other);
    if (!before.empty()) before.pop_back();
    EXPECT_EQ(are_standing(session.world, before), standing_decisions(session.world) == before);
  }
  EXPECT_GT(same, 20);
  EXPECT_GT(other, 20);
}

TEST_F(StandingTest, WhatStaysIsNotToldAgain) {
  EXPECT_TRUE(changes().empty());
  EXPECT_EQ(refusal(ada, CommandKind::kSetExclusion, peg, with_other(wall, "glued")),
            Refusal::kNone);
  std::vector<StandingChange> told = changes();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].holds);
  EXPECT_EQ(told[0].decision.details.text, "glued");

  // The later word about a pair takes the place of the earlier, also the other way round.
  before = standing_decisions(session.world);
  EXPECT_EQ(refusal(bob, CommandKind::kSetExclusion, wall, with_other(peg, "welded")),
            Refusal::kNone);
  told = changes();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_FALSE(told[0].holds);
  EXPECT_EQ(told[0].decision.details.text, "glued");
  EXPECT_TRUE(told[1].holds);
  EXPECT_EQ(told[1].decision.details.text, "welded");

  // The same once more changes nothing.
  before = standing_decisions(session.world);
  ask(bob, CommandKind::kSetExclusion, wall, with_other(peg, "welded"));
  EXPECT_TRUE(changes().empty());
}

}  // namespace
}  // namespace mortise
