// The demo under the tick's budget of work: what is told is what is told without one, and its log
// plays again.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/io/log/replay.h"
#include "common/messages/names.h"
#include "tests/golden/played_session.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

Result<test::PlayedSession> gearbox(bool work_budget, std::uint64_t arrival_seed = 0) {
  const auto scenarios = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
  StepSwitches switches;
  switches.work_budget = work_budget;
  return test::play_session(scenarios / "gearbox.yaml", scenarios / "gearbox.play.yaml", 1,
                            switches, arrival_seed);
}

// Begin, end and every other class of every pair of parts, in their order. That a depth has grown
// since it was told is told as well, and depends on the tick in which it was.
using Told = std::map<std::string, std::vector<std::string>>;
Told told_in(const test::PlayedSession& session) {
  const auto name = [&](PartId part) { return session.scene.world.find(part)->name; };
  Told told;
  for (const TickRecord& record : session.ticks)
    for (const ClashEvent& event : record.report.events) {
      const std::string now(name_of(event.verdict.collision_class));
      std::vector<std::string>& of_pair = told[name(event.part_a) + " - " + name(event.part_b)];
      if (event.kind == ClashEvent::Kind::kChange && !of_pair.empty() &&
          of_pair.back().ends_with(" " + now))
        continue;
      of_pair.push_back(std::string(name_of(event.kind)) + " " + now);
    }
  return told;
}

TEST(BudgetPlay, TheDemoTellsWhatItTellsWithout) {
  const auto with = gearbox(true), without = gearbox(false);
  ASSERT_TRUE(with) << with.error().text;
  ASSERT_TRUE(without) << without.error().text;
  std::uint64_t waiting = 0;
  for (const TickRecord& record : with->ticks) waiting += record.report.counters.pairs_waiting;
  EXPECT_EQ(waiting, 0U) << "an ordinary scene does not reach the budget";
  EXPECT_EQ(told_in(*with), told_in(*without));
  for (std::size_t i = 0; i < with->scene.world.parts.size(); ++i) {
    const Part &a = with->scene.world.parts[i], &b = without->scene.world.parts[i];
    EXPECT_EQ(a.X_WP.p, b.X_WP.p) << a.name;
  }

  const test::TestFolder folder;
  const auto file = folder.path() / "budget_play.mcap";
  ASSERT_TRUE(test::write_log(*with, file));
  const auto log = read_session_log(file);
  ASSERT_TRUE(log) << log.error().text;
  const auto report = verify(*log, 2);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference) << report->difference->what;
  EXPECT_EQ(report->ticks_compared, with->ticks.size());
}

// However the increments arrive: the press fit is told real, the bearing stays at the mouth, and no
// pair is left unexamined.
TEST(BudgetPlay, ThePressFitIsToldHoweverIncrementsArrive) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(5)); ++seed) {
    const auto played = gearbox(true, seed);
    ASSERT_TRUE(played) << played.error().text;
    std::uint64_t not_examined = 0;
    for (const TickRecord& record : played->ticks)
      not_examined += record.report.counters.not_examined;
    EXPECT_EQ(not_examined, 0U) << "seed " << seed;
    const Told told = told_in(*played);
    const auto pair = told.find("cover - bearing_out_upper");
    ASSERT_NE(pair, told.end()) << "seed " << seed << " " << testing::PrintToString(told);
    EXPECT_EQ(pair->second.back().substr(pair->second.back().find(' ') + 1), "real") << seed;
    const World& world = played->scene.world;
    EXPECT_GT(world.find_part("bearing_out_upper")->X_WP.p.z(),
              world.find_part("bearing_in_upper")->X_WP.p.z() + 1.0)
        << seed;
  }
}

// Programs start when they do: whoever is late, the same clashes of the same classes are told.
TEST(BudgetPlay, EachDesignerMayBeThreeSecondsLate) {
  const auto scenarios = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
  const auto on_time = read_play(scenarios / "gearbox.play.yaml");
  ASSERT_TRUE(on_time) << on_time.error().text;
  std::ostringstream yaml;
  yaml << std::ifstream(scenarios / "gearbox.yaml").rdbuf();
  const auto told_with = [&](const Play& play) {
    const auto played = test::play_session("gearbox.yaml", yaml.str(), play);
    EXPECT_TRUE(played) << played.error().text;
    return played ? told_in(*played) : Told{};
  };
  const Told told = told_with(*on_time);
  EXPECT_EQ(told.at("cover - bearing_out_upper"), std::vector<std::string>{"begin real"});
  for (const std::string& user : on_time->users()) {
    Play late = *on_time;
    for (Play::Act& act : late.acts) act.at_s += act.user == user ? 3.0 : 0.0;
    EXPECT_EQ(told_with(late), told) << user;
  }
}

}  // namespace
}  // namespace mortise
