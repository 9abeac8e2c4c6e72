// Every scenario of the house can be played: it loads without a finding, and its play names users
// and parts that are there. A new scenario appears here by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/io/scenario/play_file.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"
#include "common/math/rotation.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

bool is_play(const fs::path& file) { return file.stem().extension() == ".play"; }

std::vector<fs::path> files(bool plays) {
  std::vector<fs::path> list;
  for (const auto& entry : fs::directory_iterator(fs::path(MORTISE_SOURCE_DIR) / "scenarios"))
    if (entry.path().extension() == ".yaml" && is_play(entry.path()) == plays)
      list.push_back(entry.path());
  std::sort(list.begin(), list.end());
  return list;
}

LoadedScene loaded(const fs::path& file) {
  const auto reading = read_scenario(file);
  EXPECT_TRUE(reading) << reading.error().text;
  if (!reading) return {};
  for (const Finding& finding : reading->findings) ADD_FAILURE() << finding.text;
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene) << scene.error().text;
  if (!scene) return {};
  for (const Finding& finding : scene->findings) ADD_FAILURE() << finding.text;
  return std::move(*scene);
}

TEST(Scenarios, EveryOneLoadsWithoutAFinding) {
  ASSERT_GE(files(false).size(), 7U);
  for (const fs::path& file : files(false)) {
    const LoadedScene scene = loaded(file);
    EXPECT_EQ(scene.world.name, file.stem()) << "a scenario is named like its file";
    for (const Part& part : scene.world.parts)
      EXPECT_TRUE(part.solid->topology().closed()) << file << " " << part.name;
  }
}

TEST(Scenarios, EveryPlayFitsItsScenario) {
  ASSERT_GE(files(true).size(), 5U);
  for (const fs::path& file : files(true)) {
    const auto play = read_play(file);
    ASSERT_TRUE(play) << play.error().text;
    const fs::path scenario = file.parent_path() / (file.stem().stem().string() + ".yaml");
    LoadedScene scene = loaded(scenario);
    const std::vector<std::string> users = play->users();
    for (std::uint32_t i = 0; i < users.size(); ++i)
      apply_decision(scene.world, {Decision::Kind::kJoin, UserId{i + 1}, PartId{}, users[i]});
    for (const Play::Act& act : play->acts) {
      const Part* part = scene.world.find_part(act.part);
      ASSERT_NE(part, nullptr) << file << ":" << act.line << ": " << act.part;
      const auto user = std::find(users.begin(), users.end(), act.user) - users.begin();
      Decision decision;
      const Command grab{UserId{static_cast<std::uint32_t>(user + 1)}, part->id, 1,
                         CommandKind::kGrab};
      const Reply reply = apply_command(scene.world, grab, decision);
      EXPECT_EQ(reply.refusal, Refusal::kNone) << file << ":" << act.line << ": " << reply.text;
      for (const Play::Step& step : act.steps) {
        const double ticks = step.seconds * scene.world.tick_rate_hz;
        EXPECT_LE(step.by_mm.norm() / ticks, scene.world.max_jump_mm) << file << ":" << act.line;
      }
    }
  }
}

TEST(Scenarios, GearboxStartsApart) {
  const LoadedScene scene = loaded(fs::path(MORTISE_SOURCE_DIR) / "scenarios" / "gearbox.yaml");
  EXPECT_GE(scene.world.parts.size(), 12U);
  for (const Part& a : scene.world.parts)
    for (const Part& b : scene.world.parts) {
      if (!(a.id < b.id) || (!a.moving && !b.moving)) continue;
      const Box box_a = bounds_of(transformed(a.solid->mesh(), a.X_WP));
      const Box box_b = bounds_of(transformed(b.solid->mesh(), b.X_WP));
      EXPECT_FALSE(box_a.overlaps(box_b)) << a.name << " and " << b.name;
    }
}

/// Poses of all parts `time_s` after the start, as if nothing were ever in the way.
void place(World& world, const std::vector<Pose>& start, const Play& play, double time_s) {
  for (Part& part : world.parts) {
    Vec3 moved_mm = Vec3::Zero(), turned_rad = Vec3::Zero();
    for (const Play::Act& act : play.acts) {
      if (act.part != part.name) continue;
      double begin_s = act.at_s;
      for (const Play::Step& step : act.steps) {
        const double share = std::clamp((time_s - begin_s) / step.seconds, 0.0, 1.0);
        moved_mm += share * step.by_mm;
        turned_rad += share * step.rotate_rad;
        begin_s += step.seconds;
      }
    }
    const Pose& X_W0 = start[part.id.value - 1];
    const Vec3& center_P = part.solid->sphere().center_mm;
    part.X_WP.q = (rotation_exp(turned_rad) * X_W0.q).normalized();
    part.X_WP.p = X_W0 * center_P + moved_mm - part.X_WP.q * center_P;
  }
}

/// Pairs whose surfaces cross at some sampled time of the play.
std::set<std::string> crossing_pairs(const std::string& name, double until_s, double step_s) {
  const fs::path folder = fs::path(MORTISE_SOURCE_DIR) / "scenarios";
  LoadedScene scene = loaded(folder / (name + ".yaml"));
  const auto play = read_play(folder / (name + ".play.yaml"));
  EXPECT_TRUE(play);
  std::vector<Pose> start;
  for (const Part& part : scene.world.parts) start.push_back(part.X_WP);
  std::set<std::string> pairs;
  CcdScratch scratch;
  for (double time_s = 0.0; time_s <= until_s; time_s += step_s) {
    place(scene.world, start, *play, time_s);
    for (const Part& a : scene.world.parts)
      for (const Part& b : scene.world.parts)
        if (a.id < b.id && (a.moving || b.moving) &&
            surfaces_cross(*a.solid, a.X_WP, *b.solid, b.X_WP, scratch))
          pairs.insert(a.name + " " + b.name);
  }
  return pairs;
}

TEST(Scenarios, GearboxGoesTogetherAndOnlyItsFitsCross) {
  EXPECT_EQ(crossing_pairs("gearbox", 26.0, 0.1),
            (std::set<std::string>{
                "bearing_in_lower input_shaft", "bearing_out_lower output_shaft",  // H7/g6
                "bearing_in_upper input_shaft", "bearing_out_upper output_shaft",  // H7/g6
                "cover bearing_in_upper",                                          // H7/h6
                "cover bearing_out_upper",                                         // H7/p6
                "input_shaft gear_in", "output_shaft gear_out",                    // H7/k6
                "cover dowel_1", "cover dowel_2", "housing dowel_1",
                "housing dowel_2",     // H7/m6
                "housing screw_1"}));  // the clumsy push
}

TEST(Scenarios, NutIsFreeAlongTheHelixAndStopsAtTheFlank) {
  EXPECT_TRUE(crossing_pairs("bolt_and_nut", 6.4, 0.02).empty());
  EXPECT_FALSE(crossing_pairs("bolt_and_nut", 7.5, 0.02).empty());
}

}  // namespace
}  // namespace mortise
