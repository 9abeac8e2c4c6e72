// A snap: the server chooses what the user left open.
#include <gtest/gtest.h>

#include <memory>

#include "common/geometry/recognition/recognition.h"
#include "common/session/guide/snap_candidates.h"
#include "tests/unit/session/guided_pair.h"
#include "tests/unit/session/report_digest.h"

namespace mortise {
namespace {

struct Snap : GuidedPair {
  Decision decision;
  Reply snap(const Constraint& wish) {
    Details details;
    details.constraint = wish;
    return apply_command(session.world, {ada, pin, 1, CommandKind::kSnap, details}, decision);
  }
  static Constraint wish(ConstraintKind kind = ConstraintKind::kUnknown, FeatureOf other = {},
                         const std::string& feature = "") {
    return {kind, {PartId{}, feature}, std::move(other), 0.0, true};
  }
};

TEST_F(Snap, TakesTheNearestAndSaysWhich) {
  const auto nearest = snap_candidates(session.world, pin, {});
  ASSERT_FALSE(nearest.empty());
  const Reply reply = snap(wish());
  ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  EXPECT_EQ(decision.kind, Decision::Kind::kAddConstraint);
  const Constraint& chosen = decision.details.constraint;
  EXPECT_EQ(chosen.kind, nearest[0].constraint.kind);
  EXPECT_EQ(chosen.held.part, pin);
  EXPECT_EQ(chosen.held.feature, nearest[0].constraint.held.feature);
  EXPECT_EQ(chosen.other.part, ring);
  EXPECT_EQ(chosen.other.feature, nearest[0].constraint.other.feature);
  EXPECT_TRUE(chosen.snap);
  EXPECT_EQ(decision.details.constraint_id, ConstraintId{1});
  EXPECT_NE(reply.text.find("'pin." + chosen.held.feature + "'"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("'ring." + chosen.other.feature + "'"), std::string::npos);
  EXPECT_NE(reply.text.find("of 6 motions"), std::string::npos) << reply.text;
  play_tick(session.world, {}, scratch);
  EXPECT_LT(off(), kKept_mm);
}

TEST_F(Snap, KeepsToWhatIsNamed) {
  EXPECT_EQ(snap(wish(ConstraintKind::kCoplanar)).refusal, Refusal::kNone);
  EXPECT_EQ(decision.details.constraint.kind, ConstraintKind::kCoplanar);
  EXPECT_EQ(snap(wish(ConstraintKind::kCoaxial, {}, "shaft")).refusal, Refusal::kNone);
  EXPECT_EQ(decision.details.constraint.held.feature, "shaft");
  EXPECT_EQ(decision.details.constraint.other.feature, "bore");
}

TEST_F(Snap, WhatIsKeptAlreadyIsNotTakenTwice) {
  ASSERT_EQ(snap(wish(ConstraintKind::kCoaxial, {}, "shaft")).refusal, Refusal::kNone);
  const Reply again = snap(wish(ConstraintKind::kCoaxial, {}, "shaft"));
  EXPECT_EQ(again.refusal, Refusal::kNothingNear);
  EXPECT_NE(again.text.find("kept already"), std::string::npos) << again.text;
  EXPECT_EQ(session.world.guides.size(), 1U);
  // Any: something that takes more away, or nothing.
  while (snap(wish()).refusal == Refusal::kNone) ASSERT_LE(session.world.guides.size(), 6U);
  EXPECT_LT(guided_state(session.world, pin).freedom, 2);
}

TEST_F(Snap, FarPartsAreReachedByTheirName) {
  session.world.find(pin)->X_WP.p += Vec3(500, 0, 0);
  const Reply far = snap(wish());
  EXPECT_EQ(far.refusal, Refusal::kNothingNear);
  EXPECT_NE(far.text.find("bring it nearer"), std::string::npos) << far.text;
  EXPECT_EQ(decision.kind, Decision::Kind::kUnknown);
  const Reply named = snap(wish(ConstraintKind::kCoaxial, {ring, ""}));
  EXPECT_EQ(named.refusal, Refusal::kNone) << named.text;
  EXPECT_EQ(decision.details.constraint.other.part, ring);
}

TEST_F(Snap, WhatTheMeshShowsIsFoundOnceItWasLookedAt) {
  session.world.find(ring)->features.change().clear();
  EXPECT_EQ(snap(wish(ConstraintKind::kCoaxial)).refusal, Refusal::kNothingNear);
  const Solid& solid = *session.world.find(ring)->solid;
  session.world.recognized[solid.hash()] =
      std::make_shared<const std::vector<Feature>>(recognize_features(solid).features);
  EXPECT_EQ(snap(wish(ConstraintKind::kCoaxial)).refusal, Refusal::kNone);
  EXPECT_EQ(decision.details.constraint.other.feature, "bore_1");
}

TEST_F(Snap, IsRefusedWithAReason) {
  const auto refused = [&](UserId user, const Constraint& what) {
    Details details;
    details.constraint = what;
    const Reply reply =
        apply_command(session.world, {user, pin, 1, CommandKind::kSnap, details}, decision);
    EXPECT_FALSE(reply.text.empty());
    EXPECT_TRUE(session.world.guides.empty());
    return reply.refusal;
  };
  EXPECT_EQ(refused(bob, wish()), Refusal::kNotHolder);
  EXPECT_EQ(refused(ada, wish(ConstraintKind::kTangent)), Refusal::kConstraintUnfit);
  EXPECT_EQ(refused(ada, wish(ConstraintKind::kUnknown, {PartId{9}, ""})), Refusal::kUnknownPart);
  EXPECT_EQ(refused(ada, wish(ConstraintKind::kCoaxial, {ring, "no such"})), Refusal::kNothingNear);
  EXPECT_EQ(refused(ada, wish(ConstraintKind::kCoaxial, {}, "end")), Refusal::kNothingNear);
}

// What was chosen is a decision like any other: applied to another world it gives the same ticks.
TEST_F(Snap, ReplaysFromItsDecision) {
  struct Replayed : GuidedPair {
    void TestBody() override {}
  } other;
  ASSERT_EQ(snap(wish()).refusal, Refusal::kNone);
  apply_decision(other.session.world, decision);
  for (int i = 0; i < 20; ++i)
    ASSERT_EQ(digest(tremble(0.2, 0.01)), digest(other.tremble(0.2, 0.01))) << i;
}

TEST_F(Snap, FeaturesWithAFitInForceComeFirst) {
  Decision fit;
  fit.kind = Decision::Kind::kSetTolerance;
  fit.part = ring;
  fit.details.other_part = pin;
  fit.details.feature = "top";
  fit.details.other_feature = "end";
  fit.details.text = "±0.01";
  const auto without = snap_candidates(session.world, pin, {});
  ASSERT_NE(without.at(0).constraint.held.feature, "end") << "it would be first anyhow";
  session.world.declared = {fit};
  const auto with = snap_candidates(session.world, pin, {});
  ASSERT_EQ(with.size(), without.size());
  EXPECT_EQ(with[0].constraint.held.feature, "end");
  EXPECT_EQ(with[0].fit, "±0.01");
  EXPECT_EQ(with[1].constraint, without[0].constraint);
  const Reply reply = snap(wish());
  EXPECT_EQ(decision.details.constraint.held.feature, "end");
  EXPECT_NE(reply.text.find("their fit is ±0.01"), std::string::npos) << reply.text;
  // One that was dropped counts no more, from whichever end it was said.
  Decision dropped = fit;
  dropped.part = pin;
  dropped.details.other_part = ring;
  std::swap(dropped.details.feature, dropped.details.other_feature);
  dropped.details.text.clear();
  session.world.standing = {dropped};
  EXPECT_TRUE(snap_candidates(session.world, pin, {}).at(0).fit.empty());
}

}  // namespace
}  // namespace mortise
