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
#include "common/session/memory/session_state.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "tests/assemblies/support.h"

namespace mortise {
namespace {

std::vector<std::byte> file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// A session of nothing, to which everything of the file is added.
LoadedScene session_with(const web::BroughtAssembly& brought) {
  const auto reading = read_scenario_text(
      "name: drop\nunits: mm\npolicy: report\ndeviation: recognized\nparts: []\n", "drop.yaml");
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

// What is known of the surfaces of a part.
std::string surfaces_of(const Part& part) {
  std::string text;
  for (const SurfaceBand::Face& face : part.band.faces)
    text += face.name + " grade " + std::to_string(int(face.grade)) + " off " +
            std::to_string(face.residual_mm) + " by " + std::to_string(face.deviation_mm.lo) + " " +
            std::to_string(face.deviation_mm.hi) + " tolerance " +
            std::to_string(face.tolerance_mm.lo) + " " + std::to_string(face.tolerance_mm.hi) +
            " " + face.tolerance_source + "\n";
  return text;
}

struct Brought {
  test::Checked checked;
  Result<OpenedScene> direct;
  LoadedScene session;
};

// The same file checked, opened, and brought into a session; all three know the same of its parts.
Brought brought_from(const std::filesystem::path& file) {
  const auto read = web::read_brought_step("a.step", file_bytes(file));
  EXPECT_TRUE(read) << read.error().text;
  for (const std::string& note : read->notes)
    EXPECT_EQ(note.find("not used"), std::string::npos) << note;
  Brought b{test::checked(file), open_assembly(file), session_with(*read)};
  EXPECT_TRUE(b.direct && b.direct->usable());
  for (const Part& part : b.session.world.parts) {
    const Part& other = *b.direct->scene.world.find_part(part.name);
    EXPECT_EQ(surfaces_of(part), surfaces_of(other)) << part.name;
    EXPECT_EQ(part.band.face_of_triangle, other.band.face_of_triangle) << part.name;
  }
  return b;
}

std::string name_of(const Brought& b, const std::pair<PartId, PartId>& pair) {
  const World& world = b.checked.opened.scene.world;
  return world.find(pair.first)->name + " × " + world.find(pair.second)->name;
}

TEST(BroughtAssembly, IsJudgedAsTheFileItself) {
  Brought b = brought_from(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step");
  const Told here = verdicts_of(b.session.world);
  EXPECT_EQ(here.size(), 8U);
  EXPECT_EQ(here, verdicts_of(b.direct->scene.world));
  std::size_t compared = 0;
  for (const CheckedPair& pair : b.checked.report.pairs)
    for (const auto& ids : pair.all) {
      const auto of_pair = here.find(name_of(b, ids));
      if (of_pair == here.end()) continue;
      ++compared;
      const std::string worst = told_of(pair.verdicts.front());
      EXPECT_NE(std::ranges::find(of_pair->second, worst), of_pair->second.end())
          << of_pair->first << ": " << worst << " is not " << of_pair->second.front();
    }
  EXPECT_EQ(compared, here.size());
}

std::string class_of(const std::string& told) {
  return told.substr(told.find("class "), std::string("class 1").size());
}

TEST(BroughtAssembly, FacesOfEveryKindAreJudgedAsInTheFile) {
  const test::TestFolder folder;
  const std::string file = folder.path() / "random.step";
  std::size_t compared = 0;
  for (int seed = 1; seed <= 3; ++seed) {
    test::step_maker("random '" + file + "' " + std::to_string(seed));
    Brought b = brought_from(file);
    const Told here = verdicts_of(b.session.world), there = verdicts_of(b.direct->scene.world);
    for (const auto& [pair, verdicts] : here) {
      ASSERT_TRUE(there.contains(pair)) << pair;
      EXPECT_EQ(class_of(verdicts.front()), class_of(there.at(pair).front())) << pair;
    }
    EXPECT_EQ(here.size(), there.size());
    compared += here.size();
  }
  EXPECT_GT(compared, 10U);
}

}  // namespace
}  // namespace mortise
