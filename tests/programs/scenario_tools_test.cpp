#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

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

// What it moves out is no longer real: its mesh touches at most.
TEST_F(ScenarioTools, JudgeMovesAPartOutByItsWay) {
  const std::string deep = file("deep.yaml", blocks("9.8"));
  const Outcome moved = run("mortise-judge", deep + " --apply-way --fail-on real");
  EXPECT_EQ(moved.exit_code, 0) << moved.out;
  EXPECT_NE(moved.out.find("region 1: high was moved out"), std::string::npos) << moved.out;
  const auto json = nlohmann::json::parse(run("mortise-judge", deep + " --apply-way --json").out);
  EXPECT_TRUE(json.at("moved").is_string());
  EXPECT_LE(json.at("pairs").at(0).at("verdicts").at(0).at("delta_mm").at(0).get<double>(), 0.0);
  const auto told = nlohmann::json::parse(run("mortise-judge", deep + " --json").out);
  const auto& verdict = told.at("pairs").at(0).at("verdicts").at(0);
  EXPECT_NEAR(verdict.at("gpd_mm").at(0).get<double>(), 0.2, 1e-6);
  EXPECT_NEAR(verdict.at("gpd_mm").at(1).get<double>(), 0.2, 1e-6);
  EXPECT_EQ(verdict.at("separation").at("moves"), "b");
  EXPECT_EQ(verdict.at("separation").at("path"), "free");
  const std::string apart = file("apart.yaml", blocks("10.2"));
  EXPECT_NE(run("mortise-judge", apart + " --apply-way").exit_code, 0);
}

TEST_F(ScenarioTools, JudgeRefusesABadScenarioAndABadOption) {
  EXPECT_EQ(run("mortise-judge", file("bad.yaml", "name: a\n")).exit_code, 3);
  EXPECT_EQ(run("mortise-judge", file("a.yaml", blocks("10")) + " --fail-on fake").exit_code, 2);
}

// The name of a scene that is made of meshes is as short as one of a file must be.
TEST_F(ScenarioTools, MeshesMayHaveLongNamesAndBeMany) {
  const std::string one = folder_ / (std::string(70, 'a') + ".obj");
  ASSERT_EQ(run("mortise-generate", "block --out " + one).exit_code, 0);
  std::string many;
  for (int i = 0; i < 40; ++i) many += one + " ";
  for (const std::string& files : {one + " " + one, many}) {
    const Outcome judged = run("mortise-judge", files);
    EXPECT_EQ(judged.exit_code, 0) << judged.err;
  }
  const Outcome refused = run("mortise-judge", one + " " + one + " --fit 20");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("code: is a size alone"), std::string::npos) << refused.err;
}

// The same line from every program that reads a scenario, and none of them falls over.
TEST_F(ScenarioTools, LatinOneAndDistantPosesAreRefusedByAll) {
  const std::string latin = file("latin.yaml", "name: J\xe4ger\n" + blocks("10.2").substr(13));
  const std::string far = file("far.yaml", blocks("1e15"));
  for (const std::string& scenario : {latin, far})
    for (const char* program : {"mortise-lint", "mortise-judge"})
      for (const char* option : {"", " --json"})
        EXPECT_EQ(run(program, scenario + option).exit_code, 3) << program << " " << scenario;
  EXPECT_NE(run("mortise-lint", far).out.find("is beyond ±1e9"), std::string::npos);
  // The name of a file may be anything.
  const std::string strange = file("J\xe4ger.yaml", blocks("10.2"));
  for (const char* program : {"mortise-lint", "mortise-judge"}) {
    const Outcome outcome = run(program, strange + " --json");
    EXPECT_EQ(outcome.exit_code, 0) << program;
    EXPECT_FALSE(outcome.document().is_discarded()) << outcome.out;
  }
}

TEST_F(ScenarioTools, MeshesAreJudgedWithoutAScenario) {
  const auto make = [&](const char* name, const std::string& what) {
    EXPECT_EQ(run("mortise-generate", what + " -o " + name, folder_).exit_code, 0) << what;
  };
  make("plate.stl", "plate_with_bore bore_mm=20 facets=32");
  make("peg.stl", "dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=32 phase_rad=0.098174770");
  const auto worst = [&](const std::string& arguments) {
    const Outcome judged = run("mortise-judge", arguments + " --json", folder_);
    EXPECT_EQ(judged.exit_code, 0) << arguments << judged.err;
    return judged.document().at("pairs").at(0).at("verdicts").at(0).at("class").get<std::string>();
  };
  // Half a facet out of phase the meshes overlap by 48.2 um under each of them. Whether they are
  // round or flat, only the fit says.
  EXPECT_EQ(worst("plate.stl peg.stl"), "potential");
  EXPECT_EQ(worst("plate.stl peg.stl --fit H7/g6"), "fake");
  EXPECT_EQ(worst("peg.stl plate.stl --fit 'Ø20 H7/k6'"), "potential");
  EXPECT_EQ(worst("plate.stl peg.stl --unit mm --fit H7/p6"), "real");
  EXPECT_EQ(worst("./plate.stl " + (folder_ / "peg.stl").string() + " --fit H7/p6"), "real");
  const Outcome drawn = run(
      "mortise-judge", "plate.stl peg.stl --fit H7/p6 --picture out.png --fail-on real", folder_);
  EXPECT_EQ(drawn.exit_code, 6) << drawn.err;
  EXPECT_NE(drawn.out.find("0.5 µm beyond H7/p6"), std::string::npos) << drawn.out;
  EXPECT_GT(std::filesystem::file_size(folder_ / "out.png"), 1000U);
  // Only a declared surface holds however the parts are made.
  const auto explained = [&](const std::string& arguments) {
    return run("mortise-judge", arguments + " -v", folder_).out;
  };
  const std::string recognized = explained("plate.stl peg.stl --fit H7/p6");
  EXPECT_NE(recognized.find("as far as their meshes tell"), std::string::npos) << recognized;
  EXPECT_EQ(recognized.find("however they are made"), std::string::npos) << recognized;
  const std::string declared = explained(std::string(MORTISE_SOURCE_DIR) + "/scenarios/fits.yaml");
  EXPECT_NE(declared.find("however they are made"), std::string::npos) << declared;
  EXPECT_EQ(declared.find("as far as their meshes tell"), std::string::npos) << declared;
  // Three of them: the fit is that of the holes and shafts that stand in one another.
  make("lid.stl", "block x_mm=5 y_mm=5 z_mm=5");
  EXPECT_EQ(worst("plate.stl lid.stl peg.stl --fit H7/k6"), "potential");
}

// Wrong usage is one line that says what to do.
TEST_F(ScenarioTools, WhatIsMistakenIsSaidInOneLineWithARemedy) {
  EXPECT_EQ(run("mortise-generate", "block -o a.stl", folder_).exit_code, 0);
  file("s.yaml", blocks("10"));
  file("snippet.yaml", "parts:\n  - name: a\n    mesh: {file: a.stl, unit: mm}\n");
  struct Case {
    const char *program, *arguments;
    int exit_code;
    const char* says;
  };
  for (const Case& c :
       {Case{"judge", "a.stl", 3, "name a second one, or a scenario"},
        Case{"judge", "a.stl gone.stl", 3, "gone.stl: there is no such file"},
        Case{"judge", "a.stl s.yaml", 3, "s.yaml: is a scenario, and a mesh is expected"},
        Case{"judge", "s.yaml a.stl", 2, "one scenario, or two or more meshes"},
        Case{"judge", "s.yaml --fit H7/g6", 2, "a scenario says them itself"},
        Case{"judge", "a.stl a.stl --fit H7/g6", 3, "no hole and shaft of like size"},
        Case{"judge", ".", 3, "is a folder; name a scenario"},
        Case{"judge", "a.stl .", 3, "is a folder; name a mesh"},
        Case{"judge", "s.yaml --pictur x.svg", 2,
             "no such option: --pictur; did you mean --picture?"},
        Case{"judge", "", 2, "files is required"},
        Case{"lint", "a.stl", 3, "mortise inspect a.stl > scene.yaml"},
        Case{"lint", "s.yaml --jsn", 2, "did you mean --json?"},
        Case{"lint", "s.yaml t.yaml", 2, "'t.yaml' is one argument too many"},
        Case{"server", "a.stl --no-log", 3, "is a mesh, and a scenario"},
        Case{"inspect", ".", 3, "is a folder; name a mesh"},
        Case{"inspect", "a.stl --unit ft", 2, "--unit"},
        Case{"replay", "verfy x.mcap", 2, "no such command: verfy; did you mean 'verify'?"},
        Case{"replay", "verify --jsn x.mcap", 2, "did you mean --json?"}}) {
    const Outcome said = run(std::string("mortise-") + c.program, c.arguments, folder_);
    EXPECT_EQ(said.exit_code, c.exit_code) << c.program << " " << c.arguments << said.err;
    EXPECT_NE(said.err.find(c.says), std::string::npos) << said.err << "\nnot: " << c.says;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    EXPECT_EQ(said.out, "") << c.program;
  }
  const Outcome snippet = run("mortise-judge", "snippet.yaml", folder_);
  EXPECT_EQ(snippet.exit_code, 3);
  EXPECT_NE(snippet.err.find("give the scenario a name, e.g. name: "), std::string::npos);
  EXPECT_NE(snippet.err.find("e.g. units: mm"), std::string::npos);
}

TEST_F(ScenarioTools, NamesOfFilesThatAreNoNamesOfPartsAreReplaced) {
  const std::string right_to_left = "b\u202e.stl", no_utf8 = "a\xff.stl";
  for (const std::string& name : {right_to_left, no_utf8})
    EXPECT_EQ(
        run("mortise-generate", "block x_mm=5 y_mm=5 z_mm=5 -o '" + name + "'", folder_).exit_code,
        0);
  const std::string two = "'" + right_to_left + "' '" + right_to_left + "' --json";
  const Outcome judged = run("mortise-judge", two, folder_);
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  ASSERT_FALSE(judged.document().is_discarded()) << judged.out;
  EXPECT_EQ(judged.document().at("pairs").at(0).at("part_a"), "b?");
  const Outcome refused =
      run("mortise-judge", "'" + no_utf8 + "' '" + right_to_left + "'", folder_);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("is not UTF-8; rename the file"), std::string::npos) << refused.err;
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
}

TEST_F(ScenarioTools, ThatNothingMovesIsNoWarningOfJudge) {
  const std::string still =
      file("still.yaml", "name: s\nunits: mm\nparts:\n  - {name: a, generator: {kind: block}}\n");
  const Outcome judged = run("mortise-judge", still);
  EXPECT_EQ(judged.exit_code, 0);
  EXPECT_EQ(judged.err, "");
  EXPECT_NE(run("mortise-lint", still).out.find("nobody can move anything"), std::string::npos);
}

// An open box (one triangle is missing), inside out, with a triangle without area.
constexpr const char* kPoorCorners[] = {
    "0 0 0 0 10 0 10 10 0",  "0 0 0 10 10 0 10 0 0",   "0 0 9 10 10 9 0 10 9",
    "0 0 9 10 0 9 10 10 9",  "0 0 0 10 0 9 0 0 9",     "0 0 0 10 0 0 10 0 9",
    "0 10 0 0 10 9 10 10 9", "0 10 0 10 10 9 10 10 0", "0 0 0 0 0 9 0 10 9",
    "0 0 0 0 10 9 0 10 0",   "10 0 0 10 10 9 10 0 9",  "10 0 0 10 10 0 10 10 9"};

std::string stl(const std::vector<std::string>& triangles, bool turned) {
  std::string text = "solid poor\n";
  for (const std::string& triangle : triangles) {
    std::istringstream in(triangle);
    std::array<std::string, 3> corners;
    for (auto& corner : corners) {
      std::string x, y, z;
      in >> x >> y >> z;
      corner = "vertex " + x + " " + y + " " + z + "\n";
    }
    if (turned) std::swap(corners[1], corners[2]);
    text += "facet normal 0 0 0\nouter loop\n" + corners[0] + corners[1] + corners[2] +
            "endloop\nendfacet\n";
  }
  return text + "endsolid poor\n";
}

TEST_F(ScenarioTools, WhatTheImportFoundIsToldByEveryProgram) {
  std::vector<std::string> all(std::begin(kPoorCorners), std::end(kPoorCorners));
  std::vector<std::string> degenerate = all, open = all;
  degenerate.emplace_back("0 0 0 5 0 0 10 0 0");
  open.pop_back();
  file("turned.stl", stl(all, true));
  file("flat.stl", stl(degenerate, false));
  file("open.stl", stl(open, false));
  const char* const kNotes[] = {"all triangles faced inwards and were turned",
                                "1 triangles without area were dropped", "3 boundary"};
  std::string yaml = "name: notes\nunits: mm\nparts:\n";
  int x = 0;
  for (const char* name : {"turned", "flat", "open"})
    yaml += std::string("  - {name: ") + name + ", moving: true, mesh: {file: " + name +
            ".stl, unit: mm}, pose: {position: [" + std::to_string(x += 100) + ", 0, 0]}}\n";
  file("s.yaml", yaml);
  const std::string lint = run("mortise-lint", "s.yaml", folder_).out;
  const std::string judge = run("mortise-judge", "s.yaml", folder_).err;
  const std::string meshes = run("mortise-judge", "turned.stl flat.stl open.stl", folder_).err;
  const std::string inspect = run("mortise-inspect", "turned.stl flat.stl open.stl", folder_).err;
  // It says them before it looks for its keys, so that this needs no network.
  const std::string server = run("mortise-server", "s.yaml --no-log --keys none", folder_).err;
  for (const char* note : kNotes)
    for (const std::string* text : {&lint, &judge, &meshes, &inspect, &server}) {
      const std::size_t at = text->find(note);
      EXPECT_NE(at, std::string::npos) << note << " is not in\n" << *text;
      EXPECT_EQ(text->find(note, at + 1), std::string::npos) << "twice in\n" << *text;
    }
}

TEST_F(ScenarioTools, AStepFileThatIsNotWholeIsNotPassed) {
  std::stringstream text;
  text << std::ifstream(std::string(MORTISE_SOURCE_DIR) + "/scenarios/tensioner.step").rdbuf();
  const std::string whole = file("whole.step", text.str());
  EXPECT_EQ(run("mortise-inspect", whole).exit_code, 0);
  EXPECT_EQ(run("mortise-check", whole).exit_code, 0);
  // Without the entity that puts one of its parts in place.
  const std::string cut =
      std::regex_replace(text.str(), std::regex(R"(#\d+ = CONTEXT_DEPENDENT_SHAPE_REPR[^;]*;)"), "",
                         std::regex_constants::format_first_only);
  ASSERT_NE(cut, text.str());
  const std::string damaged = file("damaged.step", cut);
  EXPECT_EQ(run("mortise-inspect", damaged).exit_code, 7);
  const Outcome checked = run("mortise-check", damaged);
  EXPECT_EQ(checked.exit_code, 7);
  EXPECT_NE(checked.out.find("not examined: 1 of its 18 places in assemblies"), std::string::npos)
      << checked.out;
  EXPECT_EQ(run("mortise-check", damaged + " --fail-on real").exit_code, 6);
}

TEST_F(ScenarioTools, ASizeAloneIsNoFit) {
  const std::string cylinder =
      "name: s\nunits: mm\nparts:\n  - name: p\n    generator: {kind: "
      "dowel}\n    features: {journal: {iso: ";
  for (const char* size : {"20", "20.5", ".5", "Ø20"}) {
    const Outcome refused = run("mortise-lint", file("s.yaml", cylinder + size + "}}\n"));
    EXPECT_EQ(refused.exit_code, 3) << refused.out;
    EXPECT_NE(refused.out.find("is a size alone"), std::string::npos) << refused.out;
  }
  run("mortise-generate", "dowel --out a.obj", folder_);
  run("mortise-generate", "plate_with_bore --out b.obj", folder_);
  for (const char* program : {"mortise-judge", "mortise-check"})
    for (const char* code : {"20", "20.5", ".5", ".", ".."}) {
      const Outcome refused = run(program, "a.obj b.obj --fit " + std::string(code), folder_);
      EXPECT_EQ(refused.exit_code, 3) << program << " " << code;
      EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
      // A part without a face is named without a dot behind it.
      EXPECT_EQ(refused.err.find("a. "), std::string::npos) << refused.err;
    }
}

}  // namespace
