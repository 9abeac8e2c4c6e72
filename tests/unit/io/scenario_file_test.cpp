#include "common/io/scenario/scenario_file.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "common/io/scenario/scene_load.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

// Line numbers below count from this first line, which is line 1.
constexpr const char* kGood = R"(name: peg in hole
units: mm
tick_rate_hz: 120
policy: report
max_jump: 5
lease_s: 2.5
parts:
  - name: plate
    generator: {kind: ring, bore: 20, outer: 60, width: 20, facets: 64}
    tolerance: "±0.1"
    features:
      bore: {iso: H7}
      outer: {tolerance: {profile: 0.2, unequal: 0.05}}
  - name: pin
    mesh: {file: pin.stl, unit: in, scale: 2}
    chord_error: 0.05
    pose: {position: [1, 2, 3], rotation_deg: [0, 0, 90]}
    moving: true
    features:
      journal: {kind: cylinder, point: [0, 0, 0], axis: [0, 0, 2], diameter: 20, iso: Ø20 g6}
      tip: {kind: cone, point: [0, 0, -1], axis: [0, 0, 1], half_angle_deg: 30, along: [0, 5]}
fits:
  - {between: [plate.bore, "pin*.journal"], code: Ø20 H7/g6}
  - {between: [plate, pin], plus_minus: 0.02}
exclusions:
  - {between: [plate, pin], reason: pressed together in another line}
users:
  - {name: ada, may_hold: ["pin*"]}
  - {name: eve, may_hold: []}
)";

TEST(ScenarioFile, ReadsWhatIsWritten) {
  const auto reading = read_scenario_text(kGood, "good.yaml");
  ASSERT_TRUE(reading);
  for (const Finding& f : reading->findings) ADD_FAILURE() << f.text;
  const Scenario& s = reading->scenario;
  EXPECT_EQ(s.name, "peg in hole");
  EXPECT_EQ(s.tick_rate_hz, 120);
  EXPECT_EQ(s.policy, Policy::kReport);
  EXPECT_EQ(s.max_jump_mm, 5);
  EXPECT_EQ(s.lease_s, 2.5);
  ASSERT_EQ(s.parts.size(), 2U);
  EXPECT_EQ(s.parts[0].mesh.generator, "ring");
  EXPECT_EQ(s.parts[0].mesh.parameters.at("bore_mm"), 20);
  EXPECT_EQ(s.parts[0].mesh.parameters.at("facets"), 64);
  EXPECT_EQ(s.parts[0].tolerance->offset_mm, (Interval{-0.1, 0.1}));
  EXPECT_EQ(s.parts[0].features[0].surface.kind, SurfaceKind::kUnknown);
  EXPECT_EQ(s.parts[0].features[0].iso_class, "H7");
  EXPECT_NEAR(s.parts[0].features[1].tolerance->offset_mm.lo, -0.15, 1e-12);
  EXPECT_NEAR(s.parts[0].features[1].tolerance->offset_mm.hi, 0.05, 1e-12);
  const auto& pin = s.parts[1];
  EXPECT_EQ(pin.at.line, 14);
  EXPECT_DOUBLE_EQ(pin.mesh.unit_mm, 50.8);
  EXPECT_EQ(pin.chord_error_mm, 0.05);
  EXPECT_TRUE(pin.moving);
  EXPECT_LT((pin.X_WP * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm(), 1e-12);
  EXPECT_EQ(pin.features[0].at.line, 20);
  EXPECT_EQ(pin.features[0].nominal_mm, 20);
  EXPECT_EQ(pin.features[0].iso_class, "g6");
  EXPECT_EQ(pin.features[0].surface.radius_mm, 10);
  EXPECT_EQ(pin.features[0].surface.axis, Vec3::UnitZ());
  EXPECT_NEAR(pin.features[1].surface.half_angle_rad, std::numbers::pi / 6, 1e-12);
  EXPECT_EQ(*pin.features[1].along_mm, (Interval{0.0, 5.0}));
  ASSERT_EQ(s.fits.size(), 2U);
  EXPECT_EQ(s.fits[0].code, "H7/g6");
  EXPECT_EQ(s.fits[0].nominal_mm, 20);
  EXPECT_EQ(s.fits[0].part_b, "pin*");
  EXPECT_EQ(s.fits[0].feature_b, "journal");
  EXPECT_EQ(s.fits[1].tolerance->offset_mm, (Interval{-0.02, 0.02}));
  EXPECT_EQ(s.exclusions[0].at.line, 26);
  EXPECT_EQ(s.users[1].may_hold.size(), 0U);
}

TEST(ScenarioFile, LengthsFollowTheUnitOfTheFile) {
  const auto reading = read_scenario_text(
      "name: a\nunits: cm\nmax_jump: 2\nparts:\n"
      "  - {name: p, generator: {kind: dowel, diameter: 0.6, phase_deg: 180, length: 2}, "
      "pose: {position: [1, 0, 0]}, tolerance: +-0.01, moving: true}\n",
      "cm.yaml");
  ASSERT_TRUE(reading);
  for (const Finding& f : reading->findings) ADD_FAILURE() << f.text;
  const auto& part = reading->scenario.parts[0];
  EXPECT_DOUBLE_EQ(reading->scenario.max_jump_mm, 20);
  EXPECT_DOUBLE_EQ(part.mesh.parameters.at("diameter_mm"), 6);
  EXPECT_DOUBLE_EQ(part.mesh.parameters.at("phase_rad"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(part.X_WP.p.x(), 10);
  EXPECT_DOUBLE_EQ(part.tolerance->offset_mm.hi, 0.1);
  EXPECT_EQ(part.tolerance->text, "±0.1 mm");
}

TEST(ScenarioFile, RotationsInThreeWaysAgree) {
  const auto q_of = [](const std::string& pose) {
    const auto reading = read_scenario_text(
        "name: a\nunits: mm\nparts:\n  - {name: p, moving: true, generator: {kind: dowel}, pose: "
        "{" +
            pose + "}}\n",
        "a");
    EXPECT_TRUE(reading && reading->usable());
    return reading->scenario.parts.at(0).X_WP.q;
  };
  const Quat euler = q_of("rotation_deg: [90, 0, 90]");
  const Quat product = q_of("axis_angle: {axis: [0, 0, 3], angle_deg: 90}") *
                       q_of("quaternion: [0.70710678, 0.70710678, 0, 0]");
  EXPECT_NEAR(std::fabs(euler.dot(product)), 1.0, 1e-9);
}

TEST(ScenarioFile, InstancesAndRepeatsBecomeParts) {
  const auto reading = read_scenario_text(R"(name: many
units: mm
parts:
  - name: pin
    generator: {kind: dowel}
    instances:
      - {name: left, pose: {position: [-5, 0, 0]}, moving: true}
      - {name: right, pose: {position: [5, 0, 0]}}
  - name: bolt
    generator: {kind: dowel}
    moving: true
    repeat: {count: [2, 3, 1], step: [10, 20, 0]}
  - {name: row, generator: {kind: dowel}, repeat: {count: 3, step: [1, 2, 0]}}
)",
                                          "many.yaml");
  ASSERT_TRUE(reading);
  for (const Finding& f : reading->findings) ADD_FAILURE() << f.text;
  const auto& parts = reading->scenario.parts;
  ASSERT_EQ(parts.size(), 11U);
  EXPECT_EQ(parts[0].name, "left");
  EXPECT_TRUE(parts[0].moving);
  EXPECT_FALSE(parts[1].moving);
  EXPECT_EQ(parts[7].name, "bolt_6");
  EXPECT_EQ(parts[7].X_WP.p, Vec3(10, 40, 0));
  EXPECT_EQ(parts[10].X_WP.p, Vec3(2, 4, 0));
}

TEST(ScenarioFile, ATolerancePhraseMayNameItsUnit) {
  for (const auto& [phrase, mm] :
       {std::pair{"±0.1", 25.4 * 0.1}, {"+-0.1 mm", 0.1}, {"+/-0.1mm", 0.1}, {"± 20 µm", 0.02}}) {
    const auto reading = read_scenario_text(
        std::string("name: a\nunits: in\nparts:\n  - {name: p, generator: {kind: dowel}, "
                    "tolerance: \"") +
            phrase + "\"}\n",
        "a.yaml");
    ASSERT_TRUE(reading && reading->usable()) << phrase;
    EXPECT_NEAR(reading->scenario.parts[0].tolerance->offset_mm.hi, mm, 1e-12) << phrase;
  }
}

TEST(ScenarioFile, AMapTakesTheKeysOfAnother) {
  const auto reading = read_scenario_text(
      "name: a\nunits: mm\nparts:\n"
      "  - &pin {name: pin, generator: {kind: dowel, diameter: 8}, moving: true}\n"
      "  - <<: *pin\n    name: second\n"
      "  - {name: third, moving: false, <<: [*pin]}\n",
      "a.yaml");
  ASSERT_TRUE(reading);
  for (const Finding& f : reading->findings) ADD_FAILURE() << f.text;
  const auto& parts = reading->scenario.parts;
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[1].name, "second");
  EXPECT_EQ(parts[1].at.line, 5);
  EXPECT_EQ(parts[1].mesh.parameters.at("diameter_mm"), 8.0);
  EXPECT_TRUE(parts[1].moving);
  EXPECT_FALSE(parts[2].moving);  // its own key wins
}

TEST(ScenarioFile, OtherFilesInItsPlaceAreNamed) {
  const auto folder = std::filesystem::temp_directory_path();
  for (const auto& [file, says] :
       {std::pair{folder / "peg.stl",
                  "is a mesh, and a scenario (.yaml) is expected; mortise inspect"},
        {folder / "peg.STEP", "is a mesh"},
        {folder / "s.mcap", "mortise replay"},
        {folder, "is a folder; name a scenario"},
        {folder / "nothere.yaml", "cannot be read; check the path"}}) {
    const auto reading = read_scenario(file);
    ASSERT_FALSE(reading) << file;
    EXPECT_NE(reading.error().text.find(says), std::string::npos) << reading.error().text;
    EXPECT_EQ(reading.error().text.find('\n'), std::string::npos);
  }
}

TEST(ScenarioFile, ThatNothingMovesIsSaidWhereItMatters) {
  const auto still = read_scenario_text(
      "name: a\nunits: mm\nparts: [{name: p, generator: {kind: dowel}}]\n", "a.yaml");
  ASSERT_TRUE(still);
  EXPECT_TRUE(still->findings.empty());
  ASSERT_TRUE(nothing_moves(still->scenario));
  EXPECT_FALSE(nothing_moves(still->scenario)->is_error);
  EXPECT_FALSE(nothing_moves(read_scenario_text(kGood, "good.yaml")->scenario));
}

struct Fault {
  std::string yaml;
  int line;
  std::string says;
};

std::string head(const std::string& rest) {
  return std::string("name: a\nunits: mm\n").append(rest);
}
std::string part(const std::string& rest) {
  return head("parts:\n  - name: p\n    moving: true\n").append(rest);
}
const std::string kDowel = "    generator: {kind: dowel}\n";
std::string feature(const std::string& rest) {
  return part(std::string("    mesh: {file: a.stl, unit: mm}\n    features:\n      f: {")
                  .append(rest)
                  .append("}\n"));
}

std::vector<Fault> faults() {
  const std::string good = part(kDowel);
  return {
      {"name: a\nparts: []\n", 1, "units is missing"},
      {"units: mm\nparts: []\n", 1, "name is missing: give the scenario a name"},
      {"name: a\nunits: inch\n" + good.substr(18), 2, "'inch' is not known; did you mean 'in'?"},
      {good + "a: 1\n", 7, "unknown key 'a'. Known: name, units"},
      {head(""), 1, "parts is missing"},
      {head("parts: 5\n"), 3, "expected a list"},
      {"name: a\nunits: furlong\n" + good.substr(18), 2, "known: mm, cm, m, in, um"},
      {good + "polcy: stop\n", 7, "did you mean 'policy'"},
      {good + "policy: maybe\n", 7, "write stop, slide or report"},
      {good + "policy: stop\npolicy: stop\n", 8, "stands here twice"},
      {good + "tick_rate_hz: fast\n", 7, "expected a number"},
      {good + "tick_rate_hz: 0\n", 7, "between 1 and 1000"},
      {good + "tick_rate_hz: .nan\n", 7, "expected a number"},
      {good + "threads: 0\n", 7, "between 1 and 256"},
      {good + "threads: 1.5\n", 7, "a whole number"},
      {good + "max_jump: -1\n", 7, "greater than 0"},
      {good + "lease_s: 0\n", 7, "between 0.1"},
      {good + "users: [{name: u}]\n", 7, "may_hold is missing"},
      {good + "users:\n  - {name: u, may_hold: []}\n  - {name: u, may_hold: []}\n", 9, "twice"},
      {good + "exclusions:\n  - {between: [p, p]}\n", 8, "reason is missing"},
      {good + "approvals:\n  - {between: [p, p]}\n", 8, "reason is missing"},
      {good + "min_gaps:\n  - {between: [p, p]}\n", 8, "min_gap is missing"},
      {good + "exclusions:\n  - {between: [p], reason: r}\n", 8, "expected two names"},
      {good + "fits:\n  - {code: H7/g6}\n", 8, "between is missing"},
      {good + "fits:\n  - {between: [p.a, p.b]}\n", 8, "say what holds"},
      {good + "fits:\n  - {between: [p.a, p.b], code: H7/g6, plus_minus: 1}\n", 8, "keep one"},
      {good + "fits:\n  - {between: [p.a, p.b], code: Ø20 H7/g6, nominal: 21}\n", 8, "contradicts"},
      {head("parts:\n  - {name: p, moving: true}\n"), 4, "has no shape"},
      {head("parts:\n  - {moving: true, generator: {kind: dowel}}\n"), 4, "e.g. name: plate"},
      {head("parts:\n  - {name: a.b, generator: {kind: dowel}}\n"), 4, "without '.'"},
      {head("parts:\n  - {name: a, generator: {kind: dowel}}\n"
            "  - {name: a, generator: {kind: dowel}}\n"),
       5, "stands here twice"},
      {part("    mesh: {file: a.stl}\n"), 6, "unit is missing"},
      {part("    mesh: {file: a.stl, unit: ell}\n"), 6, "'ell' is not known"},
      {part("    mesh: {unit: mm}\n"), 6, "file is missing"},
      {part("    mesh: {file: a.stl, unit: mm, scale: 0}\n"), 6, "greater than 0"},
      {part("    mesh: a.stl\n"), 6, "expected keys and values"},
      {part(kDowel + "    mesh: {file: a.stl, unit: mm}\n"), 6, "keep one"},
      {part("    generator: {kind: dowl}\n"), 6, "did you mean 'dowel'"},
      {part("    generator: {kind: dowel, diametr: 5}\n"), 6, "did you mean 'diameter'"},
      {part("    generator: {diameter: 5}\n"), 6, "say its kind"},
      {part(kDowel + "    pose: {position: [1, 2]}\n"), 7, "list of 3 numbers"},
      {part(kDowel + "    pose: {position: [1,5, 2,0, 0,0]}\n"), 7, "decimals have a point"},
      {part(kDowel + "    pose: {rotation: [1, 2, 3]}\n"), 7, "did you mean 'rotation_deg'?"},
      {part(kDowel + "    <<: 5\n"), 7, "unknown key '<<'"},
      {part(kDowel + "    pose: {rotation_deg: [0,0,0], quaternion: [1,0,0,0]}\n"), 7, "keep one"},
      {part(kDowel + "    pose: {quaternion: [1, 1, 0, 0]}\n"), 7, "length 1"},
      {part(kDowel + "    pose: {axis_angle: {axis: [0,0,0], angle_deg: 5}}\n"), 7, "not be zero"},
      {part(kDowel + "    pose: {axis_angle: {axis: [0,0,1]}}\n"), 7, "angle_deg"},
      {part(kDowel + "    moving: sometimes\n")
           .replace(head("parts:\n  - name: p\n").size(), 17, ""),
       6, "true or false"},
      {part(kDowel + "    chord_error: -0.1\n"), 7, "negative"},
      {part(kDowel + "    tolerance: 0.1\n"), 7, "plus_minus"},
      {part(kDowel + "    tolerance: \"±0.1 ell\"\n"), 7, "is not understood"},
      {part(kDowel + "    tolerance: {plus_minus: -0.1}\n"), 7, "negative"},
      {part(kDowel + "    tolerance: {profile: 0.1, unequal: 0.2}\n"), 7, "between 0 and profile"},
      {part(kDowel + "    tolerance: {lower: 1, upper: 0}\n"), 7, "not be above"},
      {part(kDowel + "    tolerance: {lower: 1}\n"), 7, "needs upper"},
      {part(kDowel + "    tolerance: {}\n"), 7, "say plus_minus"},
      {part(kDowel + "    repeat: {count: 0, step: [1,0,0]}\n"), 7, "whole numbers"},
      {part(kDowel + "    repeat: {count: 100001, step: [1,0,0]}\n"), 7, "at most 100000"},
      {part(kDowel + "    repeat: {count: 2}\n"), 7, "step"},
      {part(kDowel + "    instances: []\n"), 7, "expected a list"},
      {part(kDowel + "    instances:\n      - {moving: true}\n"), 8, "name is missing"},
      {feature("point: [0,0,0]"), 8, "needs kind"},
      {part("    mesh: {file: a.stl, unit: mm}\n    deviation: none\n    features:\n"
            "      f: {iso: H7}\n"),
       9, "kind is missing"},
      {feature("kind: cylinder, point: [0,0,0], axis: [0,0,1]"), 8, "radius|diameter"},
      {feature("kind: cylnder"), 8, "not known"},
      {feature("kind: cylinder, point: [0,0,0], axis: [0,0,0], radius: 1"), 8, "not be zero"},
      {feature("kind: cylinder, point: [0,0,0], axis: [0,0,1], radius: 1, diameter: 2"), 8,
       "keep one"},
      {feature("kind: cylinder, point: [0,0,0], axis: [0,0,1], radius: -1"), 8, "greater than 0"},
      {feature("kind: cone, point: [0,0,0], axis: [0,0,1], half_angle_deg: 95"), 8, "0 and 90"},
      {feature("kind: plane, point: [0,0,0], axis: [0,0,1], along: [5, 1]"), 8, "from below to"},
      {feature("kind: plane, point: [0,0,0], axis: [0,0,1], nominal: 5"), 8, "iso"},
      {part("    mesh: {file: a.stl, unit: mm}\n    features: {a.b: {kind: plane}}\n"), 7,
       "one word"},
  };
}

TEST(ScenarioFile, EveryFaultIsFoundInItsLine) {
  for (const Fault& fault : faults()) {
    const auto reading = read_scenario_text(fault.yaml, "bad.yaml");
    ASSERT_TRUE(reading) << fault.yaml;
    EXPECT_FALSE(reading->usable()) << fault.yaml;
    const std::string place = "bad.yaml:" + std::to_string(fault.line) + ":";
    bool found = false;
    std::string all;
    for (const Finding& f : reading->findings) {
      found |=
          f.is_error && f.text.starts_with(place) && f.text.find(fault.says) != std::string::npos;
      all += "  " + f.text + "\n";
    }
    EXPECT_TRUE(found) << fault.yaml << "wanted " << place << " " << fault.says << "\ngot\n" << all;
  }
}

TEST(ScenarioFile, AllFaultsAreFoundAtOnce) {
  const auto reading = read_scenario_text(
      "nam: a\nunits: mm\npolicy: maybe\nparts:\n  - {name: p, mesh: {file: a}}\n", "bad.yaml");
  ASSERT_TRUE(reading);
  EXPECT_GE(reading->findings.size(), 4U);
}

TEST(ScenarioFile, WhatIsNoYamlIsRefusedWithItsLine) {
  const auto expect_refused = [](const std::string& yaml, const std::string& says) {
    const auto reading = read_scenario_text(yaml, "x.yaml");
    ASSERT_FALSE(reading) << yaml.substr(0, 100);
    EXPECT_NE(reading.error().text.find(says), std::string::npos) << reading.error().text;
  };
  expect_refused("name: [1, 2\nunits: mm\n", "not YAML");
  expect_refused("name: a\n\tunits: mm\n", "x.yaml:2");
  expect_refused("", "is empty");
  expect_refused("---\nname: a\n---\nname: b\n", "more than one document");
  expect_refused(std::string(100000, '['), "not YAML");
  expect_refused("a: &a [*a]\n", "");
  expect_refused(std::string((16U << 20) + 1, ' '), "16 MiB");
  // Nine lines that stand for a thousand million values.
  std::string bomb = "a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string before = std::string("*a").append(std::to_string(i - 1));
    const std::string number = std::to_string(i);
    bomb.append("a").append(number).append(": &a").append(number).append(" [").append(before);
    for (int k = 1; k < 10; ++k) bomb.append(",").append(before);
    bomb += "]\n";
  }
  expect_refused(bomb, "aliases expand");
}

TEST(ScenarioFile, AScalarOrListAtTheTopIsAFinding) {
  for (const char* yaml : {"hello", "[1, 2]"}) {
    const auto reading = read_scenario_text(yaml, "x.yaml");
    ASSERT_TRUE(reading);
    EXPECT_FALSE(reading->usable());
  }
}

TEST(ScenarioFile, AMissingFileAndAFolderAreSaidSo) {
  EXPECT_FALSE(read_scenario("/nowhere/at/all.yaml"));
  EXPECT_FALSE(read_scenario(std::filesystem::temp_directory_path()));
}

TEST(ScenarioFile, AliasesInMeasureAreWelcome) {
  const auto reading = read_scenario_text(
      "name: a\nunits: mm\nparts:\n  - {name: p, generator: &g {kind: dowel}, moving: true}\n"
      "  - {name: q, generator: *g}\n",
      "x.yaml");
  ASSERT_TRUE(reading);
  EXPECT_TRUE(reading->usable());
  EXPECT_EQ(reading->scenario.parts[1].mesh.generator, "dowel");
}

std::string errors_of(const std::string& yaml) {
  const auto reading = read_scenario_text(yaml, "a.yaml");
  if (!reading) return reading.error().text;
  std::string text;
  for (const Finding& finding : reading->findings)
    if (finding.is_error) text += finding.text + "\n";
  return text;
}

std::string peg(const std::string& keys) {
  return "name: a\nunits: mm\nparts:\n  - {name: p, moving: true, generator: {kind: dowel}" + keys +
         "}\n";
}

TEST(ScenarioDoor, OnlyUtf8ComesIn) {
  EXPECT_EQ(errors_of("name: a\nunits: mm\nparts:\n  - {name: J\xe4ger}\n"),
            "a.yaml:4: the byte 0xe4 is not UTF-8; save the file as UTF-8");
  EXPECT_NE(errors_of(std::string("\xff\xfen\0a\0m\0e\0", 10)).find("is UTF-16"),
            std::string::npos);
  EXPECT_EQ(errors_of("\xef\xbb\xbf" + peg("")), "") << "a mark in front is no harm";
  EXPECT_EQ(
      errors_of("name: Jäger Ø20\nunits: mm\nparts:\n  - {name: ö, generator: {kind: dowel}}\n"),
      "");
}

TEST(ScenarioDoor, NamesAreSeen) {
  for (const char* name : {R"("a\nb")", R"("\x01")", R"("\u202e")", R"(" ")", R"("\u00a0")"}) {
    const std::string text(name);
    EXPECT_NE(
        errors_of("name: " + text + "\nunits: mm\nparts: [{name: p, generator: {kind: dowel}}]"),
        "")
        << name;
    EXPECT_NE(
        errors_of("name: a\nunits: mm\nparts: [{name: " + text + ", generator: {kind: dowel}}]"),
        "")
        << name;
    EXPECT_NE(errors_of(peg("") + "users:\n  - {name: " + text + ", may_hold: []}\n"), "") << name;
  }
  EXPECT_NE(errors_of(peg("") + "users:\n  - {name: " + std::string(65, 'a') + ", may_hold: []}\n"),
            "");
}

// Each of these went through, and ended judge and server in a failed check or in nonsense.
TEST(ScenarioDoor, NumbersHaveARange) {
  for (const char* keys :
       {", pose: {position: [1e15, 0, 0]}", ", pose: {position: [0, 1e308, 0]}",
        ", pose: {position: [0, 0, -2e9]}", ", pose: {rotation_deg: [1e300, 0, 0]}",
        ", tolerance: \"±1e300\"", ", tolerance: {profile: 1e10}", ", chord_error: 1e12",
        ", repeat: {count: 3, step: [9e8, 0, 0]}",
        ", features: {f: {kind: sphere, point: [0, 0, 0], radius: 1e-300}}",
        ", features: {f: {kind: sphere, point: [1e20, 0, 0], radius: 1}}",
        ", features: {f: {kind: cylinder, point: [0, 0, 0], axis: [0, 0, 1], radius: 1, along: [0, "
        "1e99]}}"})
    EXPECT_NE(errors_of(peg(keys)), "") << keys;
  EXPECT_NE(errors_of("name: a\nunits: mm\nparts:\n  - {name: p, mesh: {file: a.stl, unit: mm, "
                      "scale: 1e-300}}"),
            "");
  EXPECT_NE(errors_of("max_jump: 1e12\n" + peg("")), "");
  // In metres, the number is within the range and the length is not.
  EXPECT_NE(
      errors_of(
          "name: a\nunits: m\nparts:\n  - {name: p, generator: {kind: dowel}, pose: {position: "
          "[1e7, 0, 0]}}"),
      "");
  EXPECT_EQ(errors_of(peg(", pose: {position: [7.8e6, -1e9, 0]}")), "");
}

TEST(ScenarioDoor, ManyUnknownKeysAreToldInShortTime) {
  std::string yaml = peg("");
  for (int i = 0; i < 200'000; ++i) yaml += "key" + std::to_string(i) + ": 1\n";
  const auto begun = std::chrono::steady_clock::now();
  const auto reading = read_scenario_text(yaml, "a.yaml");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->findings.size(), 21U) << "20 of them, and that there are more";
  EXPECT_NE(reading->findings.back().text.find("more than 20 unknown keys"), std::string::npos);
  if (test::timed()) {
    EXPECT_LT(took.count(), 20.0) << "it grew with the square: minutes";
  }
}

TEST(ScenarioDoor, WhatIsWrongEverywhereIsToldSoManyTimes) {
  std::string yaml = "name: a\nunits: mm\nparts:\n";
  for (int i = 0; i < 5000; ++i) yaml += "  - {name: p" + std::to_string(i) + "}\n";
  const auto reading = read_scenario_text(yaml, "a.yaml");
  ASSERT_TRUE(reading);
  EXPECT_FALSE(reading->usable());
  EXPECT_LT(reading->findings.size(), 300U);
}

TEST(ScenarioDoor, DeepAndExpandingYamlIsRefused) {
  EXPECT_FALSE(read_scenario_text(std::string(100'000, '['), "a.yaml"));
  EXPECT_FALSE(read_scenario_text("a: " + std::string(100'000, '{'), "a.yaml"));
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string n = std::to_string(i), before = "*a" + std::to_string(i - 1);
    bomb += "a" + n + ": &a" + n + " [" + before + ", " + before + "]\n";
  }
  EXPECT_FALSE(read_scenario_text(bomb, "a.yaml"));
}

// Ticks get work for so many threads, however many play them.
TEST(ScenarioFile, SaysForHowManyThreadsItIs) {
  for (const auto& [text, threads] : {std::pair("", 1), {"threads: 3\n", 3}}) {
    const auto reading = read_scenario_text(head(std::string(text) + "parts: []\n"), "a.yaml");
    ASSERT_TRUE(reading);
    const auto scene = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(scene) << scene.error().text;
    EXPECT_EQ(scene->world.threads, threads);
  }
}

TEST(ScenarioFile, MayBeginWithoutParts) {
  const auto reading = read_scenario_text(head("parts: []\n"), "empty.yaml");
  ASSERT_TRUE(reading);
  EXPECT_TRUE(reading->usable());
  ASSERT_EQ(reading->findings.size(), 1u);
  EXPECT_NE(reading->findings[0].text.find("parts is empty"), std::string::npos);
  EXPECT_FALSE(nothing_moves(reading->scenario)) << "that is said already";
  const auto scene = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_TRUE(scene->usable());
}

}  // namespace
}  // namespace mortise
