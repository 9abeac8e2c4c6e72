#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "common/generators/generators.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"

namespace mortise {
namespace {

// A ring of 32 facets and a pin of 24 as files, so that nothing is known of them but triangles.
class SceneFeatures : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("mortise_scene_features_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    write("ring", {{"bore_mm", 20}, {"outer_mm", 40}, {"width_mm", 20}, {"facets", 32}});
    write("dowel", {{"diameter_mm", 20}, {"length_mm", 30}, {"facets", 24}});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& kind, const std::map<std::string, double>& parameters) {
    const auto part = generate(kind, parameters);
    ASSERT_TRUE(part);
    std::ofstream out(folder_ / (kind + ".obj"));
    out.precision(17);
    for (const Vec3& p : part->mesh.points_mm)
      out << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
    for (const auto& t : part->mesh.triangles)
      out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }

  OpenedScene open(const std::string& head, const std::string& of_ring, const std::string& tail) {
    const auto path = folder_ / "s.yaml";
    std::ofstream(path)
        << "name: s\nunits: mm\n"
        << head << "parts:\n  - name: ring\n    mesh: {file: ring.obj, unit: mm}\n"
        << of_ring << "  - name: pin\n    mesh: {file: dowel.obj, unit: mm}\n    moving: true\n"
        << tail;
    auto opened = open_scene(path);
    EXPECT_TRUE(opened) << opened.error().text;
    return std::move(opened).value();
  }

  static std::string errors(const OpenedScene& opened) {
    std::string text;
    for (const Finding& f : opened.findings)
      if (f.is_error) text += f.text + "\n";
    return text;
  }

  static std::vector<Verdict> judged(OpenedScene& opened) {
    Scratch scratch;
    const JudgeReport report = judge_world(opened.scene.world, scratch, true);
    return report.pairs.empty() ? std::vector<Verdict>{} : report.pairs.front().verdicts;
  }

  std::filesystem::path folder_;
};

TEST_F(SceneFeatures, ARecognizedFitIsDecidedAndSaysWhatItRestsOn) {
  const std::array<std::pair<const char*, CollisionClass>, 3> kFits{
      {{"H7/g6", CollisionClass::kFake},
       {"H7/k6", CollisionClass::kPotential},
       {"H7/p6", CollisionClass::kReal}}};
  for (const auto& [code, expected] : kFits) {
    OpenedScene opened =
        open("deviation: recognized\n", "",
             std::string("fits:\n  - {between: [ring.bore_1, pin.shaft_1], code: ") + code + "}\n");
    ASSERT_TRUE(opened.usable()) << errors(opened);
    const std::vector<Verdict> verdicts = judged(opened);
    ASSERT_FALSE(verdicts.empty()) << code;
    const auto worst = std::max_element(verdicts.begin(), verdicts.end(), [](auto& a, auto& b) {
      return a.collision_class < b.collision_class;
    });
    EXPECT_EQ(worst->collision_class, expected) << code << ": " << worst->explanation;
    EXPECT_EQ(worst->grade, DeviationGrade::kRecognizedFeature) << worst->explanation;
    EXPECT_NE(worst->explanation.find("recognized"), std::string::npos) << worst->explanation;
  }
}

TEST_F(SceneFeatures, AMeshThatSaysNothingIsRecognized) {
  const OpenedScene opened = open("", "    chord_error: 0.1\n", "");
  ASSERT_TRUE(opened.usable()) << errors(opened);
  EXPECT_TRUE(opened.scene.world.parts[0].features.empty()) << "what states its error is not asked";
  EXPECT_FALSE(opened.scene.world.parts[1].features.empty());
  for (const Part& part : open("deviation: none\n", "", "").scene.world.parts)
    EXPECT_TRUE(part.features.empty());
}

TEST_F(SceneFeatures, FacetsOfAPlainShaftInItsPlainBoreMakeNoRealClash) {
  write("dowel", {{"diameter_mm", 19.98}, {"length_mm", 30}, {"facets", 96}});
  write("ring", {{"bore_mm", 20}, {"outer_mm", 40}, {"width_mm", 20}, {"facets", 24}});
  OpenedScene opened = open("", "", "");
  for (const Verdict& verdict : judged(opened))
    EXPECT_NE(verdict.collision_class, CollisionClass::kReal) << verdict.explanation;
  OpenedScene as_meshes = open("deviation: none\n", "", "");
  const std::vector<Verdict> verdicts = judged(as_meshes);
  ASSERT_FALSE(verdicts.empty()) << "the meshes cross";
  EXPECT_EQ(verdicts.front().collision_class, CollisionClass::kReal);
}

TEST_F(SceneFeatures, APartSpeaksForItself) {
  const OpenedScene opened = open("deviation: recognized\n", "    deviation: none\n", "");
  ASSERT_TRUE(opened.usable()) << errors(opened);
  EXPECT_TRUE(opened.scene.world.parts[0].features.empty());
  EXPECT_FALSE(opened.scene.world.parts[1].features.empty());
}

TEST_F(SceneFeatures, DeclaredFeaturesWinOverRecognizedOnes) {
  const OpenedScene opened =
      open("deviation: recognized\n",
           "    features:\n      hole: {kind: cylinder, point: [0, 0, 0], axis: [0, 0, 1], "
           "radius: 10, inward: true}\n",
           "");
  ASSERT_TRUE(opened.usable()) << errors(opened);
  const auto& features = opened.scene.world.parts[0].features;
  ASSERT_FALSE(features.empty());
  EXPECT_EQ(features[0].name, "hole");
  EXPECT_EQ(features[0].grade, DeviationGrade::kDeclaredFeature);
  for (const Feature& f : features) EXPECT_NE(f.name, "bore_1");
}

TEST_F(SceneFeatures, ARecognizedFeatureTakesAToleranceByName) {
  const OpenedScene opened =
      open("deviation: recognized\n", "    features:\n      bore_1: {iso: H7}\n", "");
  ASSERT_TRUE(opened.usable()) << errors(opened);
  const Feature& bore = opened.scene.world.parts[0].features[0];
  EXPECT_EQ(bore.grade, DeviationGrade::kRecognizedFeature);
  EXPECT_EQ(opened.scene.world.parts[0].band.faces[1].tolerance_source, "Ø20 H7");
}

TEST_F(SceneFeatures, WhatIsWrongIsSaidInOneLine) {
  const auto said = [&](const OpenedScene& opened, const std::string& what) {
    EXPECT_FALSE(opened.usable());
    EXPECT_NE(errors(opened).find(what), std::string::npos) << errors(opened);
  };
  said(open("deviation: guessed\n", "", ""), "'guessed' is not known");
  said(open("", "    deviation: estimated\n    chord_error: 0.1\n", ""), "remove one");
  said(open("deviation: recognized\n", "    features:\n      bore_7: {iso: H7}\n", ""),
       "no feature of this name was recognized");
  said(open("deviation: none\n", "    features:\n      bore_1: {iso: H7}\n", ""),
       "deviation: recognized");
}

TEST_F(SceneFeatures, AnEstimateNeverPassesForMore) {
  OpenedScene opened = open("deviation: estimated\n", "", "");
  ASSERT_TRUE(opened.usable()) << errors(opened);
  for (const Part& part : opened.scene.world.parts) {
    EXPECT_FALSE(part.features.empty());  // recognized ones come first
    for (const SurfaceBand::Face& face : part.band.faces)
      EXPECT_NE(face.grade, DeviationGrade::kDeclaredFeature);
  }
}

}  // namespace
}  // namespace mortise
