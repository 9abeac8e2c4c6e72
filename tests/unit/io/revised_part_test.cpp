// A part takes another mesh while its session runs: what is stated of it follows its faces.
#include <gtest/gtest.h>

#include "tests/unit/io/revised_session.h"

namespace mortise {
namespace {

TEST_F(RevisedPart, AFitFollowsItsFaceToAnotherMesh) {
  for (const char* deviation : {"deviation: none\n", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    begin(deviation);
    ASSERT_EQ(fit_of_pair(), "Ø20 H7/k6");
    const std::string told = replace(peg, dowel(20.0, 48));
    EXPECT_NE(told.find("statements: 1 as before"), std::string::npos) << told;
    EXPECT_EQ(told.find("gone"), std::string::npos) << told;
    EXPECT_EQ(fit_of_pair(), "Ø20 H7/k6");
    const StepReport report = tick();
    const auto open = snapshot_of(world()).open_clashes;
    ASSERT_EQ(open.size(), 1U);
    EXPECT_EQ(open[0].verdict.face_b, "journal");
    EXPECT_EQ(open[0].verdict.collision_class, CollisionClass::kPotential);
    // What holds of the part itself holds of the new mesh too.
    const auto& faces = world().find(peg)->band.faces;
    EXPECT_TRUE(std::ranges::any_of(faces, [](const auto& face) {
      return face.tolerance_source.find("0.001") != std::string::npos;
    }));
    expect_the_same_again();
  }
}

TEST_F(RevisedPart, WhatIsStatedOfAFaceThatIsGoneWaitsForIt) {
  for (const char* deviation : {"deviation: none\n", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    begin(deviation);
    const std::string told = replace(peg, dowel(19.0, 32));
    EXPECT_NE(told.find("journal"), std::string::npos) << told;
    EXPECT_NE(told.find("statements: 0 as before, 1 gone (Ø20 H7/k6 with plate)"),
              std::string::npos)
        << told;
    EXPECT_EQ(fit_of_pair(), "");
    EXPECT_EQ(fits(), 0U);
    tick();
    EXPECT_TRUE(snapshot_of(world()).open_clashes.empty());
    // A statement about the new mesh does not stumble over the one that waits.
    Details said;
    said.text = "±0.02";
    EXPECT_EQ(ask(CommandKind::kSetTolerance, peg, said).refusal, Refusal::kNone);
    said.feature = "journal";
    EXPECT_EQ(ask(CommandKind::kSetTolerance, peg, said).refusal, Refusal::kBadRule);
    expect_the_same_again();
    ASSERT_EQ(ask(CommandKind::kUndo, peg).refusal, Refusal::kNone);
    EXPECT_EQ(fit_of_pair(), "Ø20 H7/k6");
    EXPECT_EQ(fits(), 1U);
    tick();
    EXPECT_EQ(snapshot_of(world()).open_clashes.size(), 1U);
    expect_the_same_again();
    ASSERT_EQ(ask(CommandKind::kRedo, peg).refusal, Refusal::kNone);
    EXPECT_EQ(fits(), 0U);
    expect_the_same_again();
  }
}

// Of recognized faces names are numbers; they follow the faces, not the order of another mesh.
TEST_F(RevisedPart, AFitOfARecognizedFaceFollowsTheFace) {
  begin("deviation: recognized\n");
  Details add;
  add.edit = PartEdit{"pin", dowel(20.0, 40), Pose::translation({0, 0, -10}), true, 0.0};
  ASSERT_EQ(ask(CommandKind::kRemovePart, peg).refusal, Refusal::kNone);
  ASSERT_EQ(ask(CommandKind::kAddPart, PartId{}, add).refusal, Refusal::kNone);
  const PartId pin{4};
  std::string shaft;
  for (const Feature& feature : world().find(pin)->features)
    if (feature.surface.kind == SurfaceKind::kCylinder) shaft = feature.name;
  Details fit;
  fit.other_part = pin;
  fit.feature = "bore";
  fit.other_feature = shaft;
  fit.text = "Ø20 H7/g6";
  ASSERT_EQ(ask(CommandKind::kSetTolerance, plate, fit).refusal, Refusal::kNone);
  EXPECT_EQ(world().rule(plate, pin)->fit, "Ø20 H7/g6");
  tick();
  replace(pin, dowel(20.0, 64));
  EXPECT_EQ(world().rule(plate, pin)->fit, "Ø20 H7/g6");
  replace(pin, dowel(12.0, 64));
  EXPECT_EQ(fits(), 0U);
  for (const Feature& feature : world().find(pin)->features) EXPECT_NE(feature.name, shaft);
  replace(pin, dowel(20.0, 24));
  EXPECT_EQ(fits(), 1U);
  EXPECT_EQ(world().rule(plate, pin)->fit, "Ø20 H7/g6");
  expect_the_same_again();
}

TEST_F(RevisedPart, AConstraintFollowsItsFacesOrIsGone) {
  for (const char* deviation : {"deviation: none\n", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    begin(deviation);
    Details coaxial;
    coaxial.constraint = {ConstraintKind::kCoaxial, {peg, "journal"}, {plate, "bore"}, 0.0, false};
    ASSERT_EQ(ask(CommandKind::kAddConstraint, peg, coaxial).refusal, Refusal::kNone);
    ASSERT_EQ(world().guides.size(), 1U);
    replace(peg, dowel(20.0, 48));
    ASSERT_EQ(world().guides.size(), 1U);
    EXPECT_EQ(world().guides[0].constraint.held.feature, "journal");
    tick();
    const std::string told = replace(peg, dowel(18.0, 48));
    EXPECT_NE(told.find("coaxial with plate"), std::string::npos) << told;
    EXPECT_TRUE(world().guides.empty());
    expect_the_same_again();
  }
}

// Both fits may interfere or not; where the thresholds are, and how likely it is, are others.
TEST_F(RevisedPart, AnotherFitIsToldAlsoWhereTheClassStays) {
  begin("");
  const auto open = snapshot_of(world()).open_clashes;
  ASSERT_EQ(open.size(), 1U);
  ASSERT_EQ(open[0].verdict.collision_class, CollisionClass::kPotential);
  Details fit;
  fit.feature = "bore";
  fit.other_part = peg;
  fit.other_feature = "journal";
  fit.text = "Ø20 H7/js6";
  ASSERT_EQ(ask(CommandKind::kSetTolerance, plate, fit).refusal, Refusal::kNone);
  const StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kChange);
  EXPECT_EQ(report.events[0].clash, open[0].clash);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kPotential);
  EXPECT_GT(report.events[0].verdict.real_above_mm, open[0].verdict.real_above_mm + 0.001);
  // The same fit again is no news.
  ASSERT_EQ(ask(CommandKind::kSetTolerance, plate, fit).refusal, Refusal::kNone);
  EXPECT_TRUE(tick().events.empty());
  expect_the_same_again();
}

}  // namespace
}  // namespace mortise
