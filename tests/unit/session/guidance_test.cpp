// Guided assembly: constraints take freedom away, nothing else.
#include "common/session/guide/guidance.h"
#include "common/session/guide/snap_candidates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/session/guided_pair.h"

namespace mortise {
namespace {

TEST_F(GuidedPair, CoaxialLeavesAShiftAndATurnAndNeverDrifts) {
  const GuidanceReply reply =
      add_constraint(session.world, ada, between(ConstraintKind::kCoaxial, "shaft", "bore"));
  ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  EXPECT_EQ(reply.freedom, 2);
  EXPECT_EQ(reply.id, ConstraintId{1});
  play_tick(session.world, {}, scratch);  // it snaps by itself
  EXPECT_LT(off(), kKept_mm);
  double travelled = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Pose before = session.pose(pin);
    tremble(0.2, 0.01);
    travelled += (session.pose(pin).p - before.p).norm();
    ASSERT_LT(off(), kKept_mm) << i;
  }
  EXPECT_GT(travelled, 50.0);  // along the axis it is free
}

TEST_F(GuidedPair, SeveralConstraintsLeaveWhatAllOfThemLeave) {
  auto& w = session.world;
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kCoaxial, "shaft", "bore")).freedom, 2);
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kCoplanar, "end", "top")).freedom, 1);
  // The same once more takes nothing away.
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kCoaxial, "shaft", "bore")).freedom, 1);
  for (int i = 0; i < 300; ++i) {
    tremble(0.2, 0.05);
    ASSERT_LT(off(), kKept_mm) << i;
  }
  // Another height contradicts, and says so.
  const GuidanceReply reply =
      add_constraint(w, ada, between(ConstraintKind::kParallelDistance, "end", "top", 3.0));
  EXPECT_EQ(reply.refusal, Refusal::kConstraintConflict);
  EXPECT_NE(reply.text.find("cannot all be kept"), std::string::npos) << reply.text;
  EXPECT_EQ(w.guides.size(), 3U);
}

TEST_F(GuidedPair, NoFreedomLeftIsSaid) {
  auto& w = session.world;
  session.world.find(ring)->features.change().push_back(
      feature("flat", plane(Vec3(0, 20, 0), Vec3::UnitY())));
  add_constraint(w, ada, between(ConstraintKind::kCoaxial, "shaft", "bore"));
  add_constraint(w, ada, between(ConstraintKind::kCoplanar, "end", "top"));
  Constraint turn = between(ConstraintKind::kParallelDistance, "side", "flat", -10.0);
  const GuidanceReply reply = add_constraint(w, ada, turn);
  ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  EXPECT_EQ(reply.freedom, 0);
  EXPECT_NE(reply.text.find("no freedom is left"), std::string::npos) << reply.text;
  tremble(0.1, 0.1);
  tremble(0.1, 0.1);
  const Pose stands = session.pose(pin);
  for (int i = 0; i < 50; ++i) tremble(0.5, 0.1);
  EXPECT_LT((session.pose(pin).p - stands.p).norm(), 1e-8);
  EXPECT_LT(off(), kKept_mm);
}

TEST_F(GuidedPair, EveryKindIsKept) {
  const struct {
    Constraint constraint;
    int freedom;
  } rows[] = {{between(ConstraintKind::kCoplanar, "end", "top"), 3},
              {between(ConstraintKind::kParallelDistance, "end", "top", 7.5), 3},
              {between(ConstraintKind::kParallelDistance, "shaft", "bore", 30.0), 3},
              {between(ConstraintKind::kTangent, "shaft", "top"), 4},
              {between(ConstraintKind::kTangent, "shaft", "bore"), 3},
              {between(ConstraintKind::kTangent, "ball", "bore"), 5},
              {between(ConstraintKind::kTangent, "ball", "top"), 5},
              {between(ConstraintKind::kCoaxial, "ball", "bore"), 4},
              {between(ConstraintKind::kCoaxial, "ball", "socket"), 3}};
  session.world.policy = Policy::kReport;
  for (const auto& row : rows) {
    const GuidanceReply reply = add_constraint(session.world, ada, row.constraint);
    ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
    EXPECT_EQ(reply.freedom, row.freedom)
        << row.constraint.held.feature << " " << row.constraint.other.feature;
    for (int i = 0; i < 60; ++i) {
      tremble(0.3, 0.02);
      ASSERT_LT(off(), kKept_mm) << i;
    }
    EXPECT_EQ(drop_constraint(session.world, ada, reply.id).freedom, 6);
  }
}

TEST_F(GuidedPair, WhoMayAndWhatMayNot) {
  auto& w = session.world;
  const Constraint good = between(ConstraintKind::kCoaxial, "shaft", "bore");
  EXPECT_EQ(add_constraint(w, bob, good).refusal, Refusal::kNotHolder);
  EXPECT_EQ(add_constraint(w, UserId{9}, good).refusal, Refusal::kUnknownUser);
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kCoaxial, "neck", "bore")).refusal,
            Refusal::kUnknownFeature);
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kCoplanar, "shaft", "bore")).refusal,
            Refusal::kConstraintUnfit);
  EXPECT_EQ(add_constraint(w, ada, between(ConstraintKind::kTangent, "end", "bore")).refusal,
            Refusal::kConstraintUnfit);
  Constraint itself = good;
  itself.other = {pin, "end"};
  EXPECT_EQ(add_constraint(w, ada, itself).refusal, Refusal::kConstraintUnfit);
  Constraint nowhere = good;
  nowhere.other.part = PartId{77};
  EXPECT_EQ(add_constraint(w, ada, nowhere).refusal, Refusal::kUnknownPart);
  EXPECT_TRUE(w.guides.empty());
  const ConstraintId id = add_constraint(w, ada, good).id;
  EXPECT_EQ(drop_constraint(w, bob, id).refusal, Refusal::kNotHolder);
  EXPECT_EQ(drop_constraint(w, ada, ConstraintId{55}).refusal, Refusal::kUnknownConstraint);
  // Released, the part is free again.
  session.command(ada, pin, CommandKind::kRelease);
  EXPECT_TRUE(w.guides.empty());
}

TEST_F(GuidedPair, AFeatureThatOnlyTheMeshShowsIsFound) {
  session.world.find(ring)->features.change().clear();
  const GuidanceReply reply =
      add_constraint(session.world, ada, between(ConstraintKind::kCoaxial, "shaft", "bore_1"));
  EXPECT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  play_tick(session.world, {}, scratch);
  EXPECT_LT(off(), kKept_mm);
}

TEST_F(GuidedPair, WhatStandsInTheWayOfASnapStopsIt) {
  // A wall between the pin and its place.
  const Part& p = *session.world.find(pin);
  const Vec3 side = session.pose(ring).q * Vec3::UnitX();
  session.add("wall", cube_mesh(1.0), Pose::translation(p.X_WP * Vec3(0, 0, 20) - 11.3 * side),
              false);
  add_constraint(session.world, ada, between(ConstraintKind::kCoaxial, "shaft", "bore"));
  const StepReport report = play_tick(session.world, {}, scratch);
  EXPECT_EQ(report.counters.stopped_parts, 1U);
  EXPECT_GT(off(), 0.1);
  ASSERT_FALSE(report.events.empty());
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  // It does not press on by itself.
  EXPECT_EQ(play_tick(session.world, {}, scratch).counters.moves.in, 0U);
}

TEST_F(GuidedPair, ThePartFollowsWhatItIsBoundTo) {
  add_constraint(session.world, ada, between(ConstraintKind::kCoaxial, "shaft", "bore"));
  play_tick(session.world, {}, scratch);
  session.grab(bob, ring);
  for (int i = 0; i < 20; ++i)
    play_tick(session.world, {session.push(bob, ring, Vec3(0.001, 0, 0))}, scratch);
  play_tick(session.world, {}, scratch);
  EXPECT_LT(off(), kKept_mm);
}

TEST_F(GuidedPair, TheWayOfATurnKeepsToTheAxis) {
  add_constraint(session.world, ada, between(ConstraintKind::kCoaxial, "shaft", "bore"));
  play_tick(session.world, {}, scratch);
  // Down into the bore by turning hugely: 10 um of clearance, checked on the way.
  for (int i = 0; i < 16; ++i) {
    const Vec3 axis = session.pose(ring).q * Vec3::UnitZ();
    const StepReport report =
        play_tick(session.world, {session.push(ada, pin, -1.0 * axis, 2.0 * axis)}, scratch);
    ASSERT_EQ(report.counters.stopped_parts, 0U) << i;
  }
  EXPECT_LT((session.pose(ring).inverse() * session.pose(pin).p).z(), -1.0);
}

TEST_F(GuidedPair, CandidatesAreTheLikeAndNear) {
  const auto candidates = snap_candidates(session.world, pin, {});
  ASSERT_FALSE(candidates.empty());
  bool coaxial = false, coplanar = false;
  for (const SnapCandidate& c : candidates) {
    coaxial |= c.constraint.kind == ConstraintKind::kCoaxial &&
               c.constraint.held.feature == "shaft" && c.constraint.other.feature == "bore";
    coplanar |= c.constraint.kind == ConstraintKind::kCoplanar &&
                c.constraint.held.feature == "end" && c.constraint.other.feature == "top";
    EXPECT_EQ(check_constraint(session.world, ada, c.constraint).refusal, Refusal::kNone);
  }
  EXPECT_TRUE(coaxial);
  EXPECT_TRUE(coplanar);
  EXPECT_TRUE(snap_candidates(session.world, pin, {.distance_mm = 1e-3}).size() <
              candidates.size());
}

}  // namespace
}  // namespace mortise
