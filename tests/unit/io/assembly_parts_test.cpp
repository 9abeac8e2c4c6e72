#include "common/io/scenario/assembly_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/io/log/replay.h"
#include "common/io/scenario/general_tolerance.h"
#include "common/io/scenario/scene_load.h"
#include "common/io/step/given_parts.h"
#include "tests/unit/io/log_samples.h"
#include "tests/unit/io/step_samples.h"

namespace mortise {
namespace {

constexpr const char* kAssembly = "name: a\nunits: mm\nassembly: {file: a.step";

ScenarioReading read_with(const StepDocument& document, const std::string& more = "") {
  auto reading = read_scenario_text(kAssembly + more, "s.yaml");
  EXPECT_TRUE(reading) << reading.error().text;
  add_assembly(*reading, encode(document));
  return std::move(*reading);
}

LoadedScene load_assembly(const ScenarioReading& reading) {
  for (const Finding& f : reading.findings) EXPECT_FALSE(f.is_error) << f.text;
  auto scene = load_scene(reading.scenario, default_meshes());
  EXPECT_TRUE(scene);
  for (const Finding& f : scene->findings) EXPECT_FALSE(f.is_error) << f.text;
  return std::move(*scene);
}

const SurfaceBand::Face* face_named(const Part& part, const std::string& name) {
  for (const auto& face : part.band.faces)
    if (face.name == name) return &face;
  return nullptr;
}

TEST(AssemblyParts, InstancesArePartsUnderTheirPaths) {
  const ScenarioReading reading =
      read_with(test::ring_and_pins(), ", fixed: [base/ring], bought: [\"servo/*\"]}\n");
  const LoadedScene scene = load_assembly(reading);
  ASSERT_EQ(scene.world.parts.size(), 3U);
  EXPECT_EQ(scene.world.parts[0].name, "base/ring");
  EXPECT_EQ(scene.world.parts[1].name, "base/pin_1");  // '.' parts a path from a feature
  EXPECT_FALSE(scene.world.parts[0].moving);
  EXPECT_TRUE(scene.world.parts[1].moving);
  EXPECT_TRUE(reading.scenario.parts[2].bought);
  EXPECT_FALSE(reading.scenario.parts[1].bought);
  EXPECT_EQ(scene.world.parts[1].solid, scene.world.parts[2].solid);
  EXPECT_EQ(scene.world.parts[1].kind, scene.world.parts[2].kind);
  const auto* bore = face_named(scene.world.parts[0], "bore_1");
  ASSERT_NE(bore, nullptr);
  ASSERT_TRUE(bore->surface.has_value());
  EXPECT_EQ(bore->surface->radius_mm, 10.0);
  EXPECT_EQ(bore->grade, DeviationGrade::kDeclaredFeature);
}

TEST(AssemblyParts, FitsNamePathsWithGlobs) {
  const LoadedScene scene = load_assembly(
      read_with(test::ring_and_pins(),
                "}\nfits:\n  - {between: [\"*/ring\", \"base/pin*\"], code: Ø20 H7/g6}\n"));
  ASSERT_EQ(scene.fits.size(), 1U);
  EXPECT_EQ(scene.fits[0].code, "Ø20 H7/g6");
}

TEST(AssemblyParts, AFaceIsAddressedByItsGeometry) {
  const std::string statements =
      ", statements: [{part: \"*/pin*\", face: {kind: cylinder, diameter: 20, inward: false}, iso: "
      "g6}]}\n";
  StepDocument document = test::ring_and_pins();
  const LoadedScene before = load_assembly(read_with(document, statements));
  // Another export numbers the faces anew, and has the parts of the tree in another order.
  StepPart& pin = document.parts[1];
  std::reverse(pin.faces.begin(), pin.faces.end());
  for (std::uint32_t& f : pin.face_of_triangle)
    f = static_cast<std::uint32_t>(pin.faces.size()) - 1 - f;
  std::reverse(document.instances.begin(), document.instances.end());
  const LoadedScene after = load_assembly(read_with(document, statements));
  for (const LoadedScene* scene : {&before, &after})
    for (const Part& part : scene->world.parts) {
      if (part.name.find("pin") == std::string::npos) continue;
      const auto* shaft = face_named(part, "shaft_1");
      ASSERT_NE(shaft, nullptr) << part.name;
      EXPECT_EQ(shaft->tolerance_source, "Ø20 g6");
      EXPECT_NEAR(shaft->tolerance_mm.lo, -0.010, 1e-9);
      EXPECT_NEAR(shaft->tolerance_mm.hi, -0.0035, 1e-9);
    }
}

TEST(AssemblyParts, AStatementThatNoLongerMatchesIsSaid) {
  const ScenarioReading reading = read_with(
      test::ring_and_pins(),
      ", statements: [{part: \"*/pin*\", face: {kind: cylinder, diameter: 19}, iso: g6}, {part: "
      "base/rung, tolerance: \"±0.1\"}]}\n");
  EXPECT_TRUE(reading.usable());
  ASSERT_EQ(reading.findings.size(), 2U);
  EXPECT_NE(reading.findings[0].text.find("has no such face"), std::string::npos);
  EXPECT_NE(reading.findings[1].text.find("did you mean"), std::string::npos)
      << reading.findings[1].text;
}

TEST(AssemblyParts, TheGeneralToleranceIsOfSizesThatNobodyStates) {
  const LoadedScene scene = load_assembly(read_with(
      test::ring_and_pins(),
      ", general: ISO 2768-mK, statements: [{part: \"*/pin*\", face: {kind: cylinder}, iso: "
      "h6}]}\n"));
  EXPECT_NEAR(face_named(scene.world.parts[0], "bore_1")->tolerance_mm.hi, 0.1, 1e-12);
  EXPECT_EQ(face_named(scene.world.parts[1], "shaft_1")->tolerance_source, "Ø20 h6");
  EXPECT_EQ(general_class("ISO 2768-mK"), "m");
  EXPECT_FALSE(general_class("ISO 2768-x"));
  EXPECT_EQ(general_deviation_mm("f", 6.0), 0.05);
  EXPECT_EQ(general_deviation_mm("c", 6.1), 0.5);
  EXPECT_FALSE(general_deviation_mm("v", 2.0));
  EXPECT_FALSE(general_deviation_mm("m", 0.4));
}

// The four ways in which the reader's own document model gets these wrong are not ours.
TEST(AssemblyParts, StatementsOfTheFileKeepTheirSigns) {
  StepDocument document = test::ring_and_pins();
  const auto state = [&](std::uint32_t part, bool inward, double upper, double lower) {
    StepStatement s;
    s.kind = StepStatement::Kind::kSize;
    s.name = "diameter";
    s.value = 20.0;
    s.upper = upper;
    s.lower = lower;
    s.faces = {{part, test::cylinder_of(document.parts[part], inward)}};
    document.statements.push_back(s);
  };
  state(1, false, -0.007, -0.020);  // g6: both below
  state(0, true, 0.033, 0.012);     // both above
  StepStatement distance;
  distance.kind = StepStatement::Kind::kDistance;
  document.statements.push_back(distance);
  const ScenarioReading reading = read_with(document, "}\n");
  const LoadedScene scene = load_assembly(reading);
  const auto* shaft = face_named(scene.world.parts[1], "shaft_1");
  EXPECT_NEAR(shaft->tolerance_mm.lo, -0.010, 1e-9);
  EXPECT_NEAR(shaft->tolerance_mm.hi, -0.0035, 1e-9);
  const auto* bore = face_named(scene.world.parts[0], "bore_1");
  EXPECT_NEAR(bore->tolerance_mm.lo, -0.0165, 1e-9);  // a larger hole is inward of the material
  EXPECT_NEAR(bore->tolerance_mm.hi, -0.006, 1e-9);
  ASSERT_EQ(reading.scenario.assembly->listed.size(), 3U);
  EXPECT_TRUE(reading.scenario.assembly->listed[0].used);
  EXPECT_FALSE(reading.scenario.assembly->listed[2].used);
  EXPECT_FALSE(reading.scenario.assembly->listed[2].reason.empty());
}

TEST(AssemblyParts, ASizeThatTheModelHasNotIsNotUsed) {
  StepDocument document = test::ring_and_pins();
  StepStatement s;
  s.kind = StepStatement::Kind::kSize;
  s.name = "diameter";
  s.limit_lower = 24.9;
  s.limit_upper = 25.1;
  s.faces = {{1, test::cylinder_of(document.parts[1], false)}};
  document.statements.push_back(s);
  const ScenarioReading reading = read_with(document, "}\n");
  EXPECT_FALSE(reading.scenario.assembly->listed[0].used);
  EXPECT_NE(reading.scenario.assembly->listed[0].reason.find("another size"), std::string::npos);
}

TEST(AssemblyParts, ALogNeedsNoStepFile) {
  const std::string yaml = std::string(kAssembly) + "}\n";
  const LoadedScene scene = load_assembly(read_with(test::ring_and_pins(), "}\n"));
  ASSERT_NE(scene.assembly, nullptr);
  const test::TemporaryFile file("assembly.mcap");
  {
    auto writer = SessionLogWriter::create(file.path(), log_header(scene, "s", "s.yaml", yaml));
    ASSERT_TRUE(writer) << writer.error().text;
    ASSERT_TRUE((*writer)->close());
  }
  auto log = read_session_log(file.path());
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_EQ(log->assembly, *scene.assembly);
  const auto again = scene_of(*log);
  ASSERT_TRUE(again) << again.error().text;
  ASSERT_EQ(again->world.parts.size(), scene.world.parts.size());
  for (std::size_t i = 0; i < scene.world.parts.size(); ++i) {
    EXPECT_EQ(again->world.parts[i].name, scene.world.parts[i].name);
    EXPECT_EQ(again->world.parts[i].features.size(), scene.world.parts[i].features.size());
    EXPECT_EQ(again->world.parts[i].band.faces.size(), scene.world.parts[i].band.faces.size());
  }
  log->assembly.clear();
  EXPECT_FALSE(scene_of(*log));  // said, not played without it
}

TEST(AssemblyParts, DamagedBytesAreAnErrorOfTheScenario) {
  auto reading = read_scenario_text(std::string(kAssembly) + "}\n", "s.yaml");
  std::vector<std::byte> bytes = encode(test::ring_and_pins());
  bytes.pop_back();
  add_assembly(*reading, bytes);
  EXPECT_FALSE(reading->usable());
}

TEST(AssemblyParts, WhatCouldNotBeReadIsToldApartFromNotes) {
  StepDocument document = test::ring_and_pins();
  document.notes = {"2 places in the tree have no faces and were left out"};
  EXPECT_TRUE(not_read_of(read_with(document, "}\n").scenario).empty());
  document.notes.emplace_back("1 of its 3 places in assemblies could not be read");
  document.parts[1].untriangulated = 2;
  EXPECT_EQ(not_read_of(read_with(document, "}\n").scenario),
            (std::vector<std::string>{
                document.notes[1], document.parts[1].name + ": 2 faces could not be tessellated"}));
}

TEST(AssemblyParts, LongPathsKeepTheirEnds) {
  const std::string name = part_name_of(std::string(300, 'x') + "/horn");
  EXPECT_LE(name.size(), 128U);
  EXPECT_TRUE(name.ends_with("/horn"));
  EXPECT_EQ(part_name_of("a.b/c*"), "a_b/c_");
}

// What stands in one place is judged by pairs: a small file may ask for billions of them.
TEST(AssemblyParts, MorePairsThanCanBeJudgedAreRefused) {
  StepDocument document = test::ring_and_pins();
  const StepInstance pin = document.instances.back();
  for (int i = 0; i < 2100; ++i) {
    document.instances.push_back(pin);
    document.instances.back().path += std::to_string(i);
  }
  EXPECT_TRUE(is_crowded(document));
  const ScenarioReading refused = read_with(document, "}\n");
  ASSERT_FALSE(refused.usable());
  EXPECT_NE(refused.findings.back().text.find("its 2103 instances meet in more than 2000000 pairs"),
            std::string::npos);
  for (std::size_t i = 3; i < document.instances.size(); ++i)
    document.instances[i].X_WP = Pose::translation({0.0, 30.0 * static_cast<double>(i), 0.0});
  EXPECT_FALSE(is_crowded(document));
}

}  // namespace
}  // namespace mortise
