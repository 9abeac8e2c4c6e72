// A STEP file that is dropped on the page, as far as there is no browser in it: what the gateway
// reads, in a session, is judged as the same file is by a session of it, and by a check.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>

#include "client/web/step_reader.h"
#include "common/io/scenario/brought_part.h"
#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "tests/assemblies/support.h"

namespace mortise {
namespace {

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// A session of nothing but a part far away, to which everything of the file is added.
LoadedScene session_with(const web::BroughtAssembly& brought) {
  const auto reading = read_scenario_text(
      "name: drop\nunits: mm\npolicy: report\ndeviation: recognized\nparts:\n"
      "  - {name: far, generator: {kind: block, x: 1, y: 1, z: 1}, moving: true, "
      "pose: {position: [0, 0, -9000]}}\n",
      "drop.yaml");
  EXPECT_TRUE(reading && reading->usable());
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene && scene->usable());
  World& world = scene->world;
  Decision join;
  join.kind = Decision::Kind::kJoin;
  join.user = UserId{1};
  join.user_name = "ann";
  join.role = Role::kDesigner;
  apply_decision(world, join);
  std::uint64_t seq = 0;
  for (const auto& place : brought.places) {
    auto mesh = brought_mesh(brought.meshes[place.mesh]);
    EXPECT_TRUE(mesh) << mesh.error().text;
    const auto solid = std::make_shared<const Solid>(std::move(*mesh));
    world.shapes->add(solid, 0.0);
    Command add{UserId{1}, PartId{}, ++seq, CommandKind::kAddPart};
    add.details.edit = PartEdit{place.name, solid->hash(), place.X_WP, true, 0.0};
    Decision decision;
    const Reply reply = apply_command(world, add, decision);
    EXPECT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  }
  return std::move(*scene);
}

using Told = std::map<std::string, std::vector<std::string>>;

std::string told_of(const Verdict& v) {
  const auto um = [](double mm) { return std::to_string(std::llround(mm * 1e6)); };
  return v.face_a + " " + v.face_b + " class " + std::to_string(int(v.collision_class)) +
         " grade " + std::to_string(int(v.grade)) + " fake below " + um(v.fake_below_mm) +
         " nm, real above " + um(v.real_above_mm) + " nm";
}

Told verdicts_of(World& world) {
  Scratch scratch(2);
  for (int i = 0; i < 40; ++i) step(world, {}, scratch);
  Told told;
  for (const ClashEvent& clash : snapshot_of(world).open_clashes)
    told[world.find(clash.part_a)->name + " × " + world.find(clash.part_b)->name].push_back(
        told_of(clash.verdict));
  for (auto& [pair, verdicts] : told) std::ranges::sort(verdicts);
  return told;
}

TEST(BroughtAssembly, IsJudgedAsTheFileItself) {
  const auto file = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step";
  const test::Checked c = test::checked(file);
  auto direct = open_assembly(file);
  ASSERT_TRUE(direct && direct->usable());
  const auto brought = web::read_brought_step("tensioner.step", bytes_of(file));
  ASSERT_TRUE(brought) << brought.error().text;
  for (const std::string& note : brought->notes)
    EXPECT_EQ(note.find("not used"), std::string::npos) << note;
  LoadedScene session = session_with(*brought);
  const Told here = verdicts_of(session.world), there = verdicts_of(direct->scene.world);
  EXPECT_GT(here.size(), 10U);
  EXPECT_EQ(here, there);
  // The class of each pair is that of the check, and its faces are known as exactly.
  std::size_t compared = 0;
  for (const CheckedPair& pair : c.report.pairs)
    for (const auto& [a, b] : pair.all) {
      const auto name = [&](PartId id) { return c.opened.scene.world.find(id)->name; };
      const auto of_pair = here.find(name(a) + " × " + name(b));
      if (of_pair == here.end() || pair.verdicts.empty()) continue;
      ++compared;
      const std::string worst = told_of(pair.verdicts.front());
      EXPECT_NE(std::ranges::find(of_pair->second, worst), of_pair->second.end())
          << of_pair->first << ": " << worst << " is not " << of_pair->second.front();
    }
  EXPECT_GT(compared, 10U);
}

}  // namespace
}  // namespace mortise
