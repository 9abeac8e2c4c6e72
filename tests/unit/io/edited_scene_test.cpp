// Sessions whose parts come and go: their logs replay bit for bit, and a session that begins with
// what is there in the end judges it alike.
#include <gtest/gtest.h>

#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/judge_world.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/random_session.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using test::RandomSession;
using test::TestFolder;

constexpr int kTicksOfSession = 120;

std::unique_ptr<RandomSession> played(std::uint64_t seed, bool replaces = true) {
  auto session = std::make_unique<RandomSession>(seed, 3, true, replaces);
  for (int i = 1; i <= kTicksOfSession; ++i) {
    session->tick();
    if (i % 24 == 0)
      session->ticks.back().state = [bytes = encode_state(session->scene.world)] { return bytes; };
  }
  return session;
}

fs::path written(const RandomSession& session, const fs::path& file, std::uint64_t rotate_bytes) {
  LogOptions options;
  options.rotate_bytes = rotate_bytes;
  auto writer = SessionLogWriter::create(file, session.header, options);
  EXPECT_TRUE(writer) << writer.error().text;
  for (const TickRecord& tick : session.ticks) {
    (*writer)->record(tick);
    if (tick.state) {
      EXPECT_TRUE((*writer)->flush());
    }
  }
  EXPECT_TRUE((*writer)->close());
  return file;
}

TEST(EditedScene, ItsLogReplaysBitForBitFromItsBeginningAndFromEachFile) {
  std::size_t files = 0, new_meshes = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(1)); ++seed) {
    const auto session = played(seed);
    for (const TickRecord& tick : session->ticks) new_meshes += tick.meshes.size();
    const TestFolder folder;
    const fs::path file = written(*session, folder.path() / "log.mcap", 20'000);
    const auto all = read_session(file);
    ASSERT_TRUE(all) << all.error().text;
    const auto report = verify(*all, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference)
        << "seed " << seed << ", tick " << report->difference->tick << report->difference->what;
    EXPECT_EQ(report->ticks_compared, session->ticks.size());
    EXPECT_GT(report->checkpoints_compared, 3U);
    for (const fs::path& part : chain_from(file)) {
      ++files;
      const auto log = read_session_log(part);
      ASSERT_TRUE(log) << log.error().text;
      const auto alone = verify(*log, 1);
      ASSERT_TRUE(alone) << part << alone.error().text;
      EXPECT_FALSE(alone->difference) << part << alone->difference->what;
    }
  }
  EXPECT_GT(new_meshes, 0U) << "no mesh came while the session ran";
  EXPECT_GT(files, 2U);
}

// The mesh of an added part is in its log: without it the replay says so.
TEST(EditedScene, WithoutAMeshTheReplayDiffers) {
  RandomSession session(1, 3, true);
  const auto names_new_mesh = [](const TickRecord& tick) {
    return std::ranges::any_of(tick.decisions, [&](const Decision& decision) {
      return decision.details.edit && !tick.meshes.empty() &&
             decision.details.edit->mesh_hash == tick.meshes.back()->hash();
    });
  };
  while (session.ticks.size() < 400 &&
         !(session.ticks.size() > 0 && names_new_mesh(session.ticks.back())))
    session.tick();
  const std::string hash = session.ticks.back().meshes.back()->hash();
  session.tick();
  const TestFolder folder;
  auto log = read_session_log(written(session, folder.path() / "log.mcap", 0));
  ASSERT_TRUE(log) << log.error().text;
  const auto whole = verify(*log, 1);
  ASSERT_TRUE(whole) << whole.error().text;
  EXPECT_FALSE(whole->difference) << whole->difference->what;
  ASSERT_EQ(std::erase_if(log->meshes, [&](const auto& mesh) { return mesh.first == hash; }), 1U);
  const auto report = verify(*log, 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_TRUE(report->difference);
}

/// The scene that begins as the session ended: the parts that are there, where they are.
struct Fresh {
  LoadedScene scene;
  std::map<PartId, PartId> ids;  ///< of the session -> of the scene
};

Fresh fresh_scene(const World& world) {
  auto reading = read_scenario_text(test::kRandomScenario, "random.yaml");
  EXPECT_TRUE(reading);
  Scenario scenario = reading->scenario;
  std::vector<Scenario::PartSpec> specs;
  std::map<std::string, const Part*> added;
  Fresh fresh;
  bool has_peg = false;
  for (const Part& part : world.parts) {
    if (!part.present) continue;
    const std::size_t i = part.id.value - 1;
    Scenario::PartSpec spec = i < scenario.parts.size() ? scenario.parts[i] : Scenario::PartSpec{};
    if (i >= scenario.parts.size()) {
      added[part.name] = &part;
      spec.mesh.file = part.solid->hash();
      spec.undeclared = scenario.undeclared_of_meshes();
    }
    spec.name = part.name;
    spec.moving = part.moving;
    spec.X_WP = part.X_WP;
    specs.push_back(std::move(spec));
    fresh.ids[part.id] = PartId{static_cast<std::uint32_t>(specs.size())};
    has_peg |= part.name.starts_with("peg_");
  }
  scenario.parts = std::move(specs);
  if (!has_peg) scenario.fits.clear();
  auto scene = load_scene(scenario, [&](const Scenario& of, const Scenario::PartSpec& spec) {
    const auto found = added.find(spec.name);
    if (found == added.end()) return default_meshes()(of, spec);
    ImportedMesh mesh;
    mesh.mesh = found->second->solid->mesh();
    mesh.report.closed = true;
    mesh.report.quantum_mm = world.shapes->find(found->second->solid->hash()).quantum_mm;
    return Result<ImportedMesh>(std::move(mesh));
  });
  EXPECT_TRUE(scene && scene->usable());
  fresh.scene = std::move(*scene);
  // What was said of them while the session ran.
  for (Decision said : world.standing) {
    if (said.kind == Decision::Kind::kSetPolicy) continue;
    const auto here = fresh.ids.find(said.part), other = fresh.ids.find(said.details.other_part);
    if (here == fresh.ids.end() || (said.details.other_part && other == fresh.ids.end())) continue;
    said.part = here->second;
    if (said.details.other_part) said.details.other_part = other->second;
    apply_decision(fresh.scene.world, said);
  }
  return fresh;
}

std::string text_of(const PairVerdicts& pair) {
  std::string text = std::to_string(pair.a.value) + "-" + std::to_string(pair.b.value) +
                     (pair.excluded ? " excluded" : "") + (pair.not_examined ? " open" : "");
  for (const Verdict& v : pair.verdicts) {
    char line[200];
    std::snprintf(line, sizeof line, " [%d %.17g..%.17g fake %.17g real %.17g at %.17g %.17g]",
                  static_cast<int>(v.collision_class), v.delta_mm.lo, v.delta_mm.hi,
                  v.fake_below_mm, v.real_above_mm, v.point_W.x(), v.point_W.y());
    text += line;
  }
  return text;
}

TEST(EditedScene, ASceneThatBeginsAsItEndedIsJudgedAlike) {
  std::size_t verdicts = 0, added = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(4)); ++seed) {
    const auto session = played(100 + seed, false);
    World& world = session->scene.world;
    Fresh fresh = fresh_scene(world);
    Scratch one(1), two(1);
    JudgeReport as_edited = judge_world(world, one, false);
    const JudgeReport as_begun = judge_world(fresh.scene.world, two, false);
    for (PairVerdicts& pair : as_edited.pairs) {
      pair.a = fresh.ids.at(pair.a), pair.b = fresh.ids.at(pair.b);
      verdicts += pair.verdicts.size();
    }
    ASSERT_EQ(as_edited.pairs.size(), as_begun.pairs.size()) << "seed " << seed;
    for (std::size_t i = 0; i < as_begun.pairs.size(); ++i)
      EXPECT_EQ(text_of(as_edited.pairs[i]), text_of(as_begun.pairs[i])) << "seed " << seed;
    added += world.parts.size() - 8;
  }
  EXPECT_GT(verdicts, 10U);
  EXPECT_GT(added, 8U);
}

}  // namespace
}  // namespace mortise
