// A session is written as a scenario, and the scenario begins where the session stood.
#include "common/io/scenario/saved_scenario.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "common/generators/generators.h"
#include "common/io/log/replay.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/scenario/open_scene.h"
#include "common/io/scenario/scenario_file.h"
#include "common/messages/names.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/standing.h"
#include "tests/support/programs.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/log_samples.h"
#include "tests/unit/io/step_samples.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

const std::string kScenario = R"(
name: saved
units: cm
policy: stop
deviation: recognized
max_jump: 20
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 2, facets: 32}
  - name: peg
    generator: {kind: dowel, diameter: 2, length: 4, chamfer: 0.1, facets: 32, phase_deg: 5.625}
    features:
      chamfer_lower: {tolerance: {lower: -0.01, upper: -0.004}}
    moving: true
    instances:
      - {name: peg_1, pose: {position: [0, 0, 3]}}
      - {name: peg_2, pose: {position: [10, 0, 3]}}
  - {name: row, generator: {kind: block, x: 1, y: 1, z: 1}, repeat: {count: 3, step: [0, 4, 0]}, pose: {position: [-20, 0, 0]}, moving: true}
fits:
  - {between: [plate.bore, peg_*.journal], code: Ø2 H7/k6}
  - {between: [row_1, row_2], plus_minus: 0.002}
users:
  - {name: "*", may_hold: ["*"], may: [policy, tolerance, exclusions, review, parts]}
)";

class Saved : public ::testing::Test {
 protected:
  void SetUp() override {
    auto reading = read_scenario_text(kScenario, "saved.yaml");
    ASSERT_TRUE(reading && reading->usable());
    auto loaded = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(loaded && loaded->usable());
    scene = std::move(*loaded);
    header = log_header(scene, "saved", "saved.yaml", kScenario);
    Decision join;
    join.kind = Decision::Kind::kJoin;
    join.user = ann;
    join.user_name = "ann";
    join.role = Role::kDesigner;
    apply_decision(scene.world, join);
    decisions.push_back(join);
  }
  World& world() { return scene.world; }
  PartId part(const std::string& name) { return world().find_part(name)->id; }
  void ask(CommandKind kind, PartId id, Details details = {}) {
    Decision decision;
    const Reply reply = apply_command(world(), {ann, id, 1, kind, std::move(details)}, decision);
    ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
    decisions.push_back(decision);
  }
  void tick(const std::vector<Increment>& increments = {}) {
    TickRecord record;
    record.meshes = std::exchange(meshes, {});
    record.decisions = std::exchange(decisions, {});
    record.increments = increments;
    record.report = step(world(), increments, scratch);
    record.tick = record.report.tick;
    ticks.push_back(record);
  }
  void push(PartId id, const Vec3& by, const Vec3& turn = Vec3::Zero()) {
    tick({{ann, id, ++seq, by, turn}});
  }
  std::string dowel(double diameter_mm) {
    const auto made = generate("dowel", {{"diameter_mm", diameter_mm},
                                         {"length_mm", 40},
                                         {"chamfer_mm", 1},
                                         {"facets", 48},
                                         {"phase_rad", 0.098}});
    meshes.push_back(std::make_shared<const Solid>(made->mesh));
    world().shapes->add(meshes.back(), 0.0);
    return meshes.back()->hash();
  }
  void edit(CommandKind kind, PartId id, PartEdit edit) {
    Details details;
    details.edit = std::move(edit);
    ask(kind, id, details);
  }
  void write(const fs::path& file) {
    auto writer = SessionLogWriter::create(file, header, {});
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& record : ticks) (*writer)->record(record);
    ASSERT_TRUE((*writer)->close());
  }

  LoadedScene scene;
  LogHeader header;
  std::vector<TickRecord> ticks;
  std::vector<Decision> decisions;
  std::vector<SolidPtr> meshes;
  Scratch scratch;
  const UserId ann{1};
  std::uint64_t seq = 0;
};

TEST_F(Saved, TheScenarioBeginsWhereTheSessionStood) {
  const PartId plate = part("plate"), peg = part("peg_1"), other = part("peg_2");
  ask(CommandKind::kGrab, peg);
  push(peg, Vec3(0, 0, -40));
  push(peg, Vec3(0, 0, 0), Vec3(0, 0, 0.3));
  Details said;
  said.clash = snapshot_of(world()).open_clashes.at(0).clash;
  said.status = ReviewStatus::kApproved;
  said.text = "pressed in";
  ask(CommandKind::kReview, PartId{}, said);
  Details fit;
  fit.feature = "bore";
  fit.other_part = other;
  fit.other_feature = "journal";
  fit.text = "Ø2 H7/p6";
  ask(CommandKind::kSetTolerance, plate, fit);
  Details own;
  own.text = "±0.003";
  ask(CommandKind::kSetTolerance, part("row_3"), own);
  Details out;
  out.other_part = part("row_1");
  out.text = "glued";
  ask(CommandKind::kSetExclusion, plate, out);
  Details policy;
  policy.text = "slide";
  ask(CommandKind::kSetPolicy, PartId{}, policy);
  ask(CommandKind::kRemovePart, part("row_2"));
  edit(CommandKind::kAddPart, PartId{},
       {"post", dowel(12.0), Pose::translation({0, 99, 7}), true, 0.0});
  edit(CommandKind::kReplacePart, other, {"", dowel(20.0), {}, false, 0.0});
  edit(CommandKind::kSetMoving, part("row_3"), {"", "", {}, false, 0.0});
  tick();
  const test::TestFolder folder;
  write(folder.path() / "log.mcap");
  const test::Outcome run =
      test::run("mortise-replay", "export log.mcap --scenario kept", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("not kept: 1 parts in somebody's hand"), std::string::npos) << run.err;
  const auto reading = read_scenario(folder.path() / "kept" / "scenario.yaml");
  ASSERT_TRUE(reading) << reading.error().text;
  const auto again = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(again) << again.error().text;
  for (const Finding& finding : again->findings) EXPECT_FALSE(finding.is_error) << finding.text;
  const World& now = again->world;
  EXPECT_EQ(now.policy, Policy::kSlide);
  std::size_t there = 0;
  for (const Part& was : world().parts) {
    if (!was.present) continue;
    ++there;
    const Part* is = now.find_part(was.name);
    ASSERT_NE(is, nullptr) << was.name;
    EXPECT_LT((is->X_WP.p - was.X_WP.p).norm(), 1e-9) << was.name;
    EXPECT_LT(is->X_WP.q.angularDistance(was.X_WP.q), 1e-7) << was.name;
    EXPECT_EQ(is->moving, was.moving) << was.name;
    EXPECT_EQ(is->solid->mesh().triangles.size(), was.solid->mesh().triangles.size());
    EXPECT_NEAR(is->solid->sphere().radius_mm, was.solid->sphere().radius_mm, 1e-9) << was.name;
    for (const Feature& feature : was.features)
      if (feature.origin != FeatureOrigin::kRecognized) {
        EXPECT_TRUE(
            std::ranges::any_of(is->features, [&](auto& f) { return f.name == feature.name; }))
            << was.name << "." << feature.name;
      }
  }
  EXPECT_EQ(now.parts.size(), there);
  for (const auto& [ids, rule] : world().pair_rules) {
    const Part *a = world().find_present(ids.first), *b = world().find_present(ids.second);
    if (a == nullptr || b == nullptr) continue;
    const PairRule* same = now.rule(now.find_part(a->name)->id, now.find_part(b->name)->id);
    ASSERT_NE(same, nullptr) << a->name << " " << b->name;
    EXPECT_EQ(same->fit, rule.fit);
    EXPECT_EQ(same->excluded, rule.excluded);
    EXPECT_EQ(same->reason, rule.reason);
  }
  EXPECT_EQ(now.approved_at_start.size(), 1U);
  EXPECT_EQ(now.approved_at_start.begin()->second, "pressed in");
  EXPECT_EQ(now.find_part("row_3")->band.faces[0].tolerance_source,
            world().find_part("row_3")->band.faces[0].tolerance_source);
  // And it is judged alike.
  World fresh = now;
  Scratch other_scratch;
  step(fresh, {}, other_scratch);
  const auto classes = [](const World& of) {
    std::multiset<std::string> all;
    for (const ClashEvent& clash : snapshot_of(of).open_clashes)
      all.insert(of.find(clash.part_a)->name + " " + of.find(clash.part_b)->name + " " +
                 std::string(name_of(clash.verdict.collision_class)) + " " +
                 std::string(name_of(clash.review.status)));
    return all;
  };
  EXPECT_EQ(classes(fresh), classes(world()));
}

// Ring and pins of a STEP file, the hole Ø20 H7 and the pins g6 by the file.
StepDocument brought_fit() {
  StepDocument document = test::ring_and_pins();
  for (const std::uint32_t part : {0U, 1U}) {
    StepStatement& size = document.statements.emplace_back();
    size.kind = StepStatement::Kind::kSize;
    size.name = "diameter";
    size.value = 20.0;
    size.code = part == 0 ? "H7" : "g6";
    size.faces = {{part, test::cylinder_of(document.parts[part], part == 0)}};
  }
  return document;
}

std::set<std::string> faces_of(const World& world, const std::string& part) {
  std::set<std::string> faces;
  if (const Part* found = world.find_part(part))
    for (const SurfaceBand::Face& face : found->band.faces)
      faces.insert(face.name + " " + std::to_string(static_cast<int>(face.grade)) + " " +
                   face.tolerance_source);
  return faces;
}

// Where the real surface of each face may lie, by its name; not in whose words.
std::map<std::string, std::string> offsets_of(const Part& part) {
  std::map<std::string, std::string> offsets;
  for (const SurfaceBand::Face& face : part.band.faces) {
    const Interval at = face.tolerance_mm;
    offsets[face.name] += std::to_string(static_cast<int>(face.grade)) + " " +
                          std::to_string(at.lo) + " " + std::to_string(at.hi) + ";";
  }
  return offsets;
}

TEST_F(Saved, PartsOfAStepFileKeepWhatItStates) {
  const StepDocument document = brought_fit();
  const auto bring = [&](std::uint32_t number) {
    meshes.push_back(
        std::make_shared<const Solid>(brought_mesh(brought_bytes(document, number)).value()));
    world().shapes->add(meshes.back(), 0.0);
    return meshes.back()->hash();
  };
  edit(CommandKind::kAddPart, PartId{},
       {"ring", bring(0), Pose::translation({0, 99, 7}), true, 0.0});
  for (const char* name : {"pin", "pin_2", "pin_3"})
    edit(CommandKind::kAddPart, PartId{}, {name, bring(1), {}, true, 0.0});
  Details said;
  said.feature = "shaft_1";
  said.text = "±0.001";
  ask(CommandKind::kSetTolerance, part("pin_2"), said);
  ask(CommandKind::kSetTolerance, part("pin_3"), said);
  said.text = "";
  ask(CommandKind::kSetTolerance, part("pin_3"), said);
  tick();
  // A part that has names of its own for its faces: told what of it is left out.
  edit(CommandKind::kReplacePart, part("peg_2"), {"", bring(1), {}, false, 0.0});
  tick();
  const test::TestFolder folder;
  write(folder.path() / "log.mcap");
  const test::Outcome run =
      test::run("mortise-replay", "export log.mcap --scenario kept", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("not kept: 1 parts that took a mesh of a STEP file"), std::string::npos)
      << run.err;
  const auto again = open_scene(folder.path() / "kept" / "scenario.yaml");
  ASSERT_TRUE(again && again->usable());
  const World& now = again->scene.world;
  EXPECT_TRUE(faces_of(now, "pin").contains("shaft_1 2 Ø20 g6"));
  EXPECT_TRUE(faces_of(now, "pin_3").contains("shaft_1 2 "));
  for (const char* name : {"ring", "pin", "pin_2", "pin_3"})
    EXPECT_EQ(faces_of(now, name), faces_of(world(), name)) << name;
}

TEST_F(Saved, AnAssemblyKeepsItsPartsWhatItsFileStatesAndTheRulesInForce) {
  const std::string yaml = R"(
name: arm
units: cm
policy: report
assembly: {file: arm.step, general: m, fixed: [base/ring]}
fits:
  - {between: [base/ring, base/pin_1], plus_minus: 0.002}
)";
  auto reading = read_scenario_text(yaml, "arm.yaml");
  ASSERT_TRUE(reading && reading->usable());
  add_assembly(*reading, encode(brought_fit()));
  auto loaded = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(loaded && loaded->usable());
  scene = std::move(*loaded);
  header = log_header(scene, "arm", "arm.yaml", yaml);
  const Decision join = decisions.front();
  apply_decision(world(), join);
  const PartId ring = part("base/ring"), pin = part("base/pin_1"), other = part("servo/pin_1");
  Details fit;
  fit.feature = "bore_1";
  fit.other_part = pin;
  fit.other_feature = "shaft_1";
  fit.text = "H7/g6";
  ask(CommandKind::kSetTolerance, ring, fit);
  Details own;
  own.feature = "shaft_1";
  ask(CommandKind::kSetTolerance, other, own);
  Details out;
  out.other_part = other;
  out.text = "glued";
  ask(CommandKind::kSetExclusion, pin, out);
  tick();
  ask(CommandKind::kGrab, other);
  push(other, Vec3(0, 0, 5));
  const test::TestFolder folder;
  write(folder.path() / "log.mcap");
  const test::Outcome run =
      test::run("mortise-replay", "export log.mcap --scenario kept", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto again = open_scene(folder.path() / "kept" / "scenario.yaml");
  ASSERT_TRUE(again) << again.error().text;
  ASSERT_TRUE(again->usable()) << again->findings.front().text;
  const World& now = again->scene.world;
  ASSERT_EQ(now.parts.size(), 3U);
  for (const Part& was : world().parts) {
    const Part* is = now.find_part(was.name);
    ASSERT_NE(is, nullptr) << was.name;
    EXPECT_LT((is->X_WP.p - was.X_WP.p).norm(), 1e-9) << was.name;
    EXPECT_EQ(is->moving, was.moving) << was.name;
    EXPECT_EQ(is->solid->mesh().triangles, was.solid->mesh().triangles) << was.name;
    EXPECT_EQ(offsets_of(*is), offsets_of(was)) << was.name;
  }
  const auto rules = [](const World& of) {
    std::multiset<std::string> all;
    for (const Decision& said : standing_decisions(of))
      if (said.details.other_part && !said.details.text.empty())
        all.insert(of.find(said.part)->name + "." + said.details.feature + " " +
                   of.find(said.details.other_part)->name + "." + said.details.other_feature);
    return all;
  };
  EXPECT_EQ(rules(now), rules(world()));
  EXPECT_EQ(rules(now).size(), 3U);
  EXPECT_EQ(now.rule(now.find_part("base/ring")->id, now.find_part("base/pin_1")->id)->fit,
            world().rule(ring, pin)->fit);
}

TEST_F(Saved, AFolderThatIsNotEmptyIsLeftAlone) {
  tick();
  const test::TestFolder folder;
  write(folder.path() / "log.mcap");
  const test::Outcome run =
      test::run("mortise-replay", "export log.mcap --scenario .", folder.path());
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("is not empty; name a new folder"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace mortise
