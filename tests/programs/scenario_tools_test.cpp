#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/programs.h"

namespace {

using mortise::test::Outcome;
using mortise::test::run;

class ScenarioTools : public mortise::test::InFolder {};

// Two blocks with their top and bottom faces this far apart (negative: overlapping).
std::string blocks(const std::string& gap) {
  return "name: blocks\nunits: mm\nparts:\n"
         "  - {name: low, generator: {kind: block, x: 20, y: 20, z: 10}, tolerance: \"±0.05\"}\n"
         "  - {name: high, generator: {kind: block, x: 10, y: 10, z: 10}, tolerance: \"±0.05\", "
         "moving: true, pose: {position: [0, 0, " +
         gap + "]}}\n";
}

TEST_F(ScenarioTools, LintSaysWhatIsRightAndWhatIsWrong) {
  const std::string good = file("good.yaml", blocks("10.2"));
  const Outcome ok = run("mortise-lint", good + " --json");
  EXPECT_EQ(ok.exit_code, 0);
  const auto json = nlohmann::json::parse(ok.out);
  EXPECT_EQ(json.at("parts").size(), 2U);
  EXPECT_TRUE(json.at("usable").get<bool>());
  EXPECT_TRUE(json.at("parts").at(0).at("closed").get<bool>());
  EXPECT_EQ(run("mortise-lint", good).out.find('\033'), std::string::npos);  // no colours in a pipe

  const std::string bad = file("bad.yaml", "name: a\nunits: mm\npolcy: stop\nparts: []\n");
  const Outcome refused = run("mortise-lint", bad);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.out.find("bad.yaml:3: "), std::string::npos) << refused.out;
  EXPECT_NE(refused.out.find("bad.yaml:4: "), std::string::npos) << refused.out;
  EXPECT_EQ(run("mortise-lint", "/nowhere.yaml").exit_code, 3);
  EXPECT_EQ(run("mortise-lint", "").exit_code, 2);
}

TEST_F(ScenarioTools, JudgeGivesTheClassesOfTheProfileZones) {
  struct Case {
    const char* z;
    const char* expected;
    int exit_real, exit_potential;
  };
  // The blocks touch at z = 10.
  for (const Case& c : {Case{"9.8", "real", 6, 6}, Case{"9.95", "potential", 0, 6},
                        Case{"10.05", "potential", 0, 6}, Case{"10.2", "", 0, 0}}) {
    const std::string scenario = file("blocks.yaml", blocks(c.z));
    const Outcome judged = run("mortise-judge", scenario + " --json --full --fail-on real");
    EXPECT_EQ(judged.exit_code, c.exit_real) << c.z;
    EXPECT_EQ(run("mortise-judge", scenario + " --fail-on potential").exit_code, c.exit_potential)
        << c.z;
    const auto json = nlohmann::json::parse(judged.out);
    if (std::string(c.expected).empty()) {
      EXPECT_TRUE(json.at("pairs").empty()) << c.z;
      continue;
    }
    ASSERT_EQ(json.at("pairs").size(), 1U) << c.z;
    const auto& verdict = json.at("pairs").at(0).at("verdicts").at(0);
    EXPECT_EQ(verdict.at("class"), c.expected) << c.z;
    EXPECT_NEAR(verdict.at("delta_mm").at(0).get<double>(), 10.0 - std::atof(c.z), 2e-4);
    EXPECT_NEAR(verdict.at("real_above_mm").get<double>(), 0.1, 2e-4);
    EXPECT_NEAR(verdict.at("fake_below_mm").get<double>(), -0.1, 2e-4);
  }
}

TEST_F(ScenarioTools, JudgeRefusesABadScenarioAndABadOption) {
  EXPECT_EQ(run("mortise-judge", file("bad.yaml", "name: a\n")).exit_code, 3);
  EXPECT_EQ(run("mortise-judge", file("a.yaml", blocks("10")) + " --fail-on fake").exit_code, 2);
}

// The same line from every program that reads a scenario, and none of them falls over.
TEST_F(ScenarioTools, LatinOneAndDistantPosesAreRefusedByAll) {
  const std::string latin = file("latin.yaml", "name: J\xe4ger\n" + blocks("10.2").substr(13));
  const std::string far = file("far.yaml", blocks("1e15"));
  for (const std::string& scenario : {latin, far})
    for (const char* program : {"mortise-lint", "mortise-judge"})
      for (const char* option : {"", " --json"})
        EXPECT_EQ(run(program, scenario + option).exit_code, 3) << program << " " << scenario;
  EXPECT_NE(run("mortise-lint", latin).out.find("latin.yaml:1: the byte 0xe4"), std::string::npos);
  EXPECT_NE(run("mortise-lint", far).out.find("1000 km"), std::string::npos);
  // The name of a file may be anything.
  const std::string strange = file("J\xe4ger.yaml", blocks("10.2"));
  for (const char* program : {"mortise-lint", "mortise-judge"}) {
    const Outcome outcome = run(program, strange + " --json");
    EXPECT_EQ(outcome.exit_code, 0) << program;
    EXPECT_FALSE(outcome.document().is_discarded()) << outcome.out;
  }
}

}  // namespace
