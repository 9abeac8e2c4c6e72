// Files as people have them: open, mirrored, rounded, far away. What judge and lint say of them.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/programs.h"
#include "tests/support/test_data.h"

namespace {

using mortise::test::Outcome;
using mortise::test::run;
using Json = nlohmann::json;

class OrdinaryFiles : public mortise::test::InFolder {};

/// An OBJ box from lo to hi, without the last `left_out` of its six faces.
std::string box_obj(double lo, double hi, int left_out = 0) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    char line[96];
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", i & 1 ? hi : lo, i & 2 ? hi : lo,
                  i & 4 ? hi : lo);
    text += line;
  }
  const char* faces[] = {"f 1 3 4 2\n", "f 5 6 8 7\n", "f 1 2 6 5\n",
                         "f 3 7 8 4\n", "f 1 5 7 3\n", "f 2 4 8 6\n"};
  for (int i = 0; i < 6 - left_out; ++i) text += faces[i];
  return text;
}

Json judged(const std::string& scenario) {
  const Outcome outcome = run("mortise-judge", scenario + " --json --full");
  EXPECT_EQ(outcome.exit_code, 0) << scenario;
  return outcome.document();
}

/// The verdicts of a pair, worst first; not an array when nothing is said of it.
Json pair_of(const Json& report, const std::string& a, const std::string& b) {
  for (const Json& pair : report.at("pairs"))
    if ((pair.at("part_a") == a && pair.at("part_b") == b) ||
        (pair.at("part_a") == b && pair.at("part_b") == a))
      return pair;
  return {};
}

std::string class_of(const Json& pair) {
  return pair.is_null() || pair.at("verdicts").empty()
             ? "none"
             : pair.at("verdicts").at(0).at("class").get<std::string>();
}

double depth_of(const Json& pair) {
  return pair.at("verdicts").at(0).at("delta_mm").at(0).get<double>();
}

TEST_F(OrdinaryFiles, WhatLiesInAnOpenPartIsNotExamined) {
  file("open.obj", box_obj(-10, 10, 1));
  file("cube.obj", box_obj(-1, 1));
  const std::string scenario = file("scene.yaml", R"(name: open
units: mm
parts:
  - {name: bin, mesh: {file: open.obj, unit: mm}}
  - {name: within, mesh: {file: cube.obj, unit: mm}, moving: true}
  - {name: beside, mesh: {file: cube.obj, unit: mm}, moving: true, pose: {position: [30, 0, 0]}}
)");
  const Json report = judged(scenario);
  const Json pair = pair_of(report, "bin", "within");
  ASSERT_FALSE(pair.is_null());
  EXPECT_TRUE(pair.at("not_examined").get<bool>());
  EXPECT_TRUE(pair_of(report, "bin", "beside").is_null());
  EXPECT_EQ(report.at("counters").at("not_examined"), 1);
  const std::string text = run("mortise-judge", scenario).out;
  EXPECT_NE(text.find("not examined  bin × within: "), std::string::npos) << text;
  EXPECT_NE(text.find("bin is open"), std::string::npos) << text;
  EXPECT_NE(text.find("1 not examined beside an open part"), std::string::npos) << text;
}

TEST_F(OrdinaryFiles, LintShowsExtentRoundingAndInside) {
  file("open.obj", box_obj(-10, 10, 1));
  file("cube.obj", box_obj(0.1, 1016.1));
  const std::string scenario = file("scene.yaml", R"(name: sizes
units: mm
parts:
  - {name: bin, mesh: {file: open.obj, unit: mm}}
  - {name: inches, mesh: {file: cube.obj, unit: in}, moving: true, mirror: x}
)");
  const Outcome lint = run("mortise-lint", scenario + " --json");
  const Json parts = lint.document().at("parts");
  EXPECT_EQ(parts.at(0).at("inside"), "no");
  EXPECT_EQ(parts.at(1).at("inside"), "yes");
  EXPECT_NEAR(parts.at(1).at("extent_mm").at(0).get<double>(), 25806.4, 1e-2);
  EXPECT_TRUE(parts.at(1).at("quantum_mm").is_number());
  const std::string text = run("mortise-lint", scenario).out;
  EXPECT_NE(text.find("20 × 20 × 20"), std::string::npos) << text;
  EXPECT_NE(text.find("rounding, µm"), std::string::npos) << text;
}

std::string case_folder(const std::string& name) {
  return (mortise::test::data_folder() / "../cases" / name).string();
}

TEST_F(OrdinaryFiles, CubesThatShareAnEdgeAFaceOrACorner) {
  const std::string folder = case_folder("44-four-triangles-an-edge");
  MORTISE_NEEDS_DATA(folder);
  const Json report = judged(folder + "/scene.yaml");
  for (const std::string which : {"a", "b", "c"}) {
    const Json pushed = pair_of(report, "two_" + which + "1", "pin_" + which + "1");
    EXPECT_EQ(class_of(pushed), "real") << which;
    EXPECT_NEAR(depth_of(pushed), 1.0, 1e-4) << which;
    const Json within = pair_of(report, "two_" + which + "2", "pin_" + which + "2");
    EXPECT_EQ(class_of(within), "real") << which;
    EXPECT_NEAR(depth_of(within), 11.0, 1e-4) << which;
  }
}

TEST_F(OrdinaryFiles, ShellsThatOverlapAndFaceInwards) {
  const std::string folder = case_folder("31-overlapping-shells");
  MORTISE_NEEDS_DATA(folder);
  const Json report = judged(folder + "/scene.yaml");
  for (const std::string which : {"a", "b", "c", "d", "e", "f"})
    EXPECT_EQ(class_of(pair_of(report, "body_" + which, "pin_" + which)), "real") << which;
  for (const std::string which : {"a", "c", "e"})
    EXPECT_NEAR(depth_of(pair_of(report, "body_" + which, "pin_" + which)), 1.0, 1e-4) << which;
}

TEST_F(OrdinaryFiles, MirroredNodesAndTurnedTriangles) {
  const std::string folder = case_folder("21-mirrored");
  MORTISE_NEEDS_DATA(folder);
  const Json report = judged(folder + "/scene.yaml");
  for (const auto& [a, b] : {std::pair("plate", "gltf_mirrored"), std::pair("plate2", "gltf_both"),
                             std::pair("plate3", "stl_mirrored")}) {
    EXPECT_EQ(class_of(pair_of(report, a, b)), "real") << b;
    EXPECT_NEAR(depth_of(pair_of(report, a, b)), 0.1, 1e-4) << b;
  }
  for (const std::string refused : {"/neg.yaml", "/neg3.yaml"})
    EXPECT_EQ(run("mortise-judge", folder + refused).exit_code, 3);
}

TEST_F(OrdinaryFiles, CracksOfRounding) {
  const std::string folder = case_folder("30-six-digits");
  MORTISE_NEEDS_DATA(folder);
  const Json report = judged(folder + "/scene.yaml");
  for (const std::string which : {"six", "crack", "cracked"})
    EXPECT_EQ(class_of(pair_of(report, "tube_" + which, "pin_" + which)), "real") << which;
}

TEST_F(OrdinaryFiles, ContactWithinTheRoundingOfFilesIsNotReal) {
  for (const std::string name : {"49-float-rounding-contact", "07-standing-on"}) {
    const std::string folder = case_folder(name);
    MORTISE_NEEDS_DATA(folder);
    EXPECT_EQ(judged(folder + "/scene.yaml").at("counters").at("verdicts").at("by_class").at("real"), 0);
  }
}

TEST_F(OrdinaryFiles, FarFromTheOrigin) {
  const std::string folder = case_folder("25-far-away");
  MORTISE_NEEDS_DATA(folder);
  const Json report = judged(folder + "/scene.yaml");
  for (const std::string digits : {"obj", "pos"}) {
    EXPECT_EQ(class_of(pair_of(report, "plate_" + digits, "block_" + digits)), "real") << digits;
    EXPECT_NEAR(depth_of(pair_of(report, "plate_" + digits, "block_" + digits)), 0.1, 1e-4);
  }
  EXPECT_EQ(class_of(pair_of(report, "plate_stl", "block_stl")), "potential");
}

}  // namespace
