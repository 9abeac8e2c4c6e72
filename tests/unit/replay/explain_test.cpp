// The chain of one clash: every step is there, and says what the engine computed.
#include "client/replay/explain.h"
#include "client/replay/explain_text.h"

#include <gtest/gtest.h>

#include "tests/unit/io/log_samples.h"
#include "tests/unit/replay/played.h"

namespace mortise {
namespace {

double number(const Json& json) { return json.get<double>(); }

TEST(Explain, EveryClashOfASessionIsExplained) {
  for (const char* name : {"peg_in_hole", "thin_wall", "blocks_profile"}) {
    const auto log = played(name);
    ASSERT_TRUE(log) << log.error().text;
    std::set<ClashId> clashes;
    for (const TickRecord& record : log->ticks)
      for (const ClashEvent& event : record.report.events) clashes.insert(event.clash);
    ASSERT_FALSE(clashes.empty()) << name;
    for (const ClashId clash : clashes) {
      const auto chain = explain_clash(*log, clash);
      ASSERT_TRUE(chain) << name << " " << clash.value << ": " << chain.error().text;
      EXPECT_EQ((*chain)["as_logged"], "") << name;
      const std::string text = explain_text(*chain);
      for (const char* step :
           {"1 Increments", "2 Motion", "3 First contact", "4 Region", "5 Concave–convex",
            "6 What the faces", "7 Thresholds", "8 Verdict", "9 What was told"})
        EXPECT_NE(text.find(step), std::string::npos) << step << "\n" << text;
      // Both thresholds are the sum of what they are made of.
      const Json& t = (*chain)["thresholds"];
      EXPECT_NEAR(number(t["fake_below_mm"]),
                  number(t["fake_by_tolerance_mm"]) + number(t["fake_by_mesh_error_mm"]), 1e-12);
      EXPECT_NEAR(number(t["real_above_mm"]),
                  number(t["real_by_tolerance_mm"]) + number(t["real_by_mesh_error_mm"]), 1e-12);
      EXPECT_NE(text.find((*chain)["verdict"]["explanation"].get<std::string>()),
                std::string::npos);
    }
  }
}

// The cube is stopped by the wall: the increments led farther than it went.
TEST(Explain, TellsWhereTheIncrementsLedAndWhereThePartWent) {
  const auto log = played("thin_wall");
  ASSERT_TRUE(log);
  const ClashEvent* first = nullptr;
  for (const TickRecord& record : log->ticks)
    for (const ClashEvent& event : record.report.events)
      if (first == nullptr) first = &event;
  ASSERT_NE(first, nullptr);
  const auto chain = explain_clash(*log, first->clash, first->tick);
  ASSERT_TRUE(chain) << chain.error().text;
  ASSERT_EQ((*chain)["increments"].size(), 1U);
  const Json& asked = (*chain)["increments"][0]["translation_mm"];
  const Json& went = (*chain)["motion"][1];
  EXPECT_EQ(went["part"], "cube");
  EXPECT_FALSE((*chain)["motion"][0]["moved"].get<bool>());
  const auto length = [](const Json& v) {
    return std::hypot(number(v[0]), number(v[1]), number(v[2]));
  };
  EXPECT_LT(length(went["translation_mm"]), length(asked));
  EXPECT_EQ((*chain)["tick"], first->tick);
  EXPECT_EQ((*chain)["verdict"]["class"], "real");
}

TEST(Explain, TheProgramSaysWhatItDoesNotHave) {
  const std::string log =
      std::string("'").append(MORTISE_SOURCE_DIR).append("/tests/golden/thin_wall.mcap'");
  EXPECT_EQ(test::run("mortise-replay", "explain " + log + " 999").exit_code, 3);
  EXPECT_EQ(test::run("mortise-replay", "explain " + log + " 1 --tick 1").exit_code, 3);
  EXPECT_EQ(test::run("mortise-replay", "explain " + log).exit_code, 2);
  const auto answer = test::run("mortise-replay", "explain --json " + log + " 1");
  ASSERT_EQ(answer.exit_code, 0);
  EXPECT_EQ(answer.document()["pair"], "wall × cube");
}

}  // namespace
}  // namespace mortise
