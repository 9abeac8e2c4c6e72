// A part takes another mesh while its session runs: what is stated of it follows its faces.
#include <gtest/gtest.h>

#include "common/generators/generators.h"
#include "common/io/log/replay.h"
#include "common/io/state/checkpoint.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/standing.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

const char* const kPlateAndPeg = R"(
name: revisions
units: mm
policy: report
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    tolerance: "±0.001"
    moving: true
    pose: {position: [0, 0, -10]}
  - {name: block, generator: {kind: block, x: 20, y: 20, z: 20}, moving: true, pose: {position: [80, 0, 0]}}
fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/k6}
)";

class RevisedPart : public ::testing::Test {
 protected:
  void begin(const std::string& deviation) {
    yaml = kPlateAndPeg + deviation;
    auto reading = read_scenario_text(yaml, "revisions.yaml");
    ASSERT_TRUE(reading && reading->usable());
    auto loaded = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(loaded && loaded->usable());
    scene = std::move(*loaded);
    header = log_header(scene, "revisions", "revisions.yaml", yaml);
    Decision join;
    join.kind = Decision::Kind::kJoin;
    join.user = ann;
    join.user_name = "ann";
    join.role = Role::kDesigner;
    apply_decision(scene.world, join);
    decisions.push_back(join);
    ask(CommandKind::kGrab, peg);
    tick();
  }
  World& world() { return scene.world; }
  Reply ask(CommandKind kind, PartId part, Details details = {}) {
    Decision decision;
    Reply reply = apply_command(world(), {ann, part, 1, kind, std::move(details)}, decision);
    if (reply.refusal == Refusal::kNone) decisions.push_back(decision);
    return reply;
  }
  StepReport tick() {
    TickRecord record;
    record.meshes = std::exchange(meshes, {});
    record.decisions = std::exchange(decisions, {});
    record.report = step(world(), {}, scratch);
    record.tick = record.report.tick;
    ticks.push_back(record);
    return record.report;
  }
  std::string dowel(double diameter_mm, int facets) {
    const auto part = generate("dowel", {{"diameter_mm", diameter_mm},
                                         {"length_mm", 40},
                                         {"chamfer_mm", 1},
                                         {"facets", facets},
                                         {"phase_rad", 0.098}});
    EXPECT_TRUE(part) << part.error().text;
    meshes.push_back(std::make_shared<const Solid>(part->mesh));
    world().shapes->add(meshes.back(), 0.0);
    return meshes.back()->hash();
  }
  std::string replace(PartId part, const std::string& hash) {
    Details details;
    details.edit.emplace().mesh_hash = hash;
    const Reply reply = ask(CommandKind::kReplacePart, part, details);
    EXPECT_EQ(reply.refusal, Refusal::kNone) << reply.text;
    return decisions.empty() ? "" : decisions.back().details.text;
  }
  std::size_t fits() {
    std::size_t count = 0;
    for (const Decision& said : standing_decisions(world()))
      count += said.kind == Decision::Kind::kSetTolerance && said.details.other_part ? 1 : 0;
    return count;
  }
  std::string fit_of_pair() {
    const PairRule* rule = world().rule(plate, peg);
    return rule != nullptr ? rule->fit : "";
  }
  /// A replay of all this, and a session that goes on from a checkpoint, come to the same.
  void expect_the_same_again() {
    tick();
    const auto state = encode_state(world());
    const test::TemporaryFile file(".mcap");
    {
      auto writer = SessionLogWriter::create(file.path(), header, {});
      ASSERT_TRUE(writer) << writer.error().text;
      for (const TickRecord& record : ticks) (*writer)->record(record);
      ASSERT_TRUE((*writer)->close());
    }
    const auto log = read_session_log(file.path());
    ASSERT_TRUE(log) << log.error().text;
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    auto reading = read_scenario_text(yaml, "revisions.yaml");
    auto fresh = load_scene(reading->scenario, default_meshes());
    for (const auto& [hash, mesh] : world().shapes->meshes())
      if (!fresh->world.shapes->find(hash).solid) fresh->world.shapes->add(mesh.solid, 0.0);
    const Status restored = restore_state(fresh->world, state);
    ASSERT_TRUE(restored) << restored.error().text;
    EXPECT_TRUE(encode_state(fresh->world) == state);
    EXPECT_EQ(standing_decisions(fresh->world), standing_decisions(world()));
  }

  std::string yaml;
  LoadedScene scene;
  LogHeader header;
  std::vector<TickRecord> ticks;
  std::vector<Decision> decisions;
  std::vector<SolidPtr> meshes;
  Scratch scratch;
  const UserId ann{1};
  const PartId plate{1}, peg{2}, block{3};
};

TEST_F(RevisedPart, AFitFollowsItsFaceToAnotherMesh) {
  for (const char* deviation : {"", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    ticks.clear(), decisions.clear();
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
  for (const char* deviation : {"", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    ticks.clear(), decisions.clear();
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
  for (const char* deviation : {"", "deviation: recognized\n"}) {
    SCOPED_TRACE(deviation);
    ticks.clear(), decisions.clear();
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

}  // namespace
}  // namespace mortise
