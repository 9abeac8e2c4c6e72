#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

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

inline constexpr const char* kPlateAndPeg = R"(
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

/// ann and a peg in its plate; what she does is done at once, and kept for a log.
class RevisedPart : public ::testing::Test {
 protected:
  void begin(const std::string& deviation) { begin_with(kPlateAndPeg + deviation); }
  void begin_with(const std::string& text) {
    yaml = text;
    ticks.clear(), decisions.clear(), meshes.clear();
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
  Result<SessionLog> written() const {
    const test::TemporaryFile file(".mcap");
    {
      auto writer = SessionLogWriter::create(file.path(), header, {});
      if (!writer) return writer.error();
      for (const TickRecord& record : ticks) (*writer)->record(record);
      if (const Status closed = (*writer)->close(); !closed) return closed.error();
    }
    return read_session_log(file.path());
  }
  /// A replay of all this, and a session that goes on from a checkpoint, come to the same.
  void expect_the_same_again() {
    tick();
    const auto state = encode_state(world());
    const auto log = written();
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

}  // namespace mortise
