#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

using test::data_folder;

// A published fit: meshes in metres, hole at its place, part moved along the common axis z.
struct RealFit {
  const char* id;
  const char* hole_file;
  const char* part_file;
  double hole_mm, part_mm;  // diameters that the meshes have
  double x_mm, z_mm;        // of the axis, and of the part in the hole
  double gap_mm;            // measured between the meshes; 0: they cross
  double chord_mm;          // declared, where corners stand farther off than 2e-4 R
};

void PrintTo(const RealFit& fit, std::ostream* out) { *out << fit.id; }

constexpr RealFit kFits[] = {
    {"round8_tight", "insertion/factory_round_hole_8mm_subdiv_3x.obj",
     "insertion/factory_round_peg_8mm_tight.obj", 8.1, 7.995, 0, -10, 0.05194, 0},
    {"round8_loose", "insertion/factory_round_hole_8mm_subdiv_3x.obj",
     "insertion/factory_round_peg_8mm_loose.obj", 8.1, 7.986, 0, -10, 0.05643, 0},
    {"round16_tight", "insertion/factory_round_hole_16mm_subdiv_3x.obj",
     "insertion/factory_round_peg_16mm_tight.obj", 16.5, 15.994, 0, -10, 0.25256, 0},
    {"round16_loose", "insertion/factory_round_hole_16mm_subdiv_3x.obj",
     "insertion/factory_round_peg_16mm_loose.obj", 16.5, 15.983, 0, -10, 0.25805, 0},
    {"gear_small_on_loose_shaft", "gears/factory_gear_base_loose_space_5e-4_subdiv_4x.obj",
     "gears/factory_gear_small_space_5e-4.obj", 9.972, 10.0, 50.5, 0.2, 0.01269, 0.002},
    {"gear_small_on_tight_shaft", "gears/factory_gear_base_tight_space_5e-4_subdiv_4x.obj",
     "gears/factory_gear_small_space_5e-4.obj", 10.0, 10.0, 50.5, 0.2, 0.0, 0.002}};

class RealFits : public testing::TestWithParam<RealFit> {
 protected:
  void SetUp() override {
    MORTISE_NEEDS_DATA(data_folder() / "fits");
    folder_ = std::filesystem::temp_directory_path() /
              ("mortise_real_fits_" + std::to_string(getpid()) + "_" + GetParam().id);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  bool gear() const { return std::string(GetParam().id).starts_with("gear"); }

  // The scenario as a user would write it; tolerance_mm 0: none declared.
  OpenedScene scene(double tolerance_mm) const {
    const RealFit& fit = GetParam();
    const auto path = folder_ / "fit.yaml";
    std::ofstream yaml(path);
    const auto part = [&](const char* name, const char* file, double diameter_mm, bool inward,
                          double z_mm, bool moving) {
      yaml << "  - name: " << name << "\n    mesh: {file: "
           << std::filesystem::absolute(data_folder() / "fits" / file).string()
           << ", unit: m}\n    pose: {position: [0, 0, " << z_mm
           << "]}\n    moving: " << (moving ? "true" : "false") << "\n";
      if (fit.chord_mm > 0.0) yaml << "    chord_error: " << fit.chord_mm << "\n";
      yaml << "    features:\n      round: {kind: cylinder, point: [" << fit.x_mm
           << ", 0, 0], axis: [0, 0, 1], diameter: " << diameter_mm
           << ", inward: " << (inward ? "true" : "false");
      if (tolerance_mm > 0.0) yaml << ", tolerance: {plus_minus: " << tolerance_mm << "}";
      yaml << "}\n";
    };
    yaml << "name: " << fit.id << "\nunits: mm\nparts:\n";
    part("base", fit.hole_file, fit.hole_mm, !gear(), 0.0, false);
    part("moved", fit.part_file, fit.part_mm, gear(), fit.z_mm, true);
    yaml.close();
    auto opened = open_scene(path);
    EXPECT_TRUE(opened) << opened.error().text;
    for (const Finding& f : opened->findings) EXPECT_FALSE(f.is_error) << f.text;
    return std::move(opened).value();
  }

  std::filesystem::path folder_;
};

std::vector<Verdict> judged(World& world, bool full_brackets = false) {
  Scratch scratch;
  const JudgeReport report = judge_world(world, scratch, full_brackets);
  return report.pairs.empty() ? std::vector<Verdict>{} : report.pairs.front().verdicts;
}

TEST_P(RealFits, FeaturesWithTheMeasuredRadiiAreFound) {
  const OpenedScene opened = scene(0.0);
  ASSERT_TRUE(opened.usable());
  for (const Part& part : opened.scene.world.parts) {
    ASSERT_FALSE(part.features.empty());
    EXPECT_EQ(part.features[0].name, "round");  // others are recognized
    EXPECT_GE(part.features[0].triangles.size(), 72U);
    EXPECT_LT(part.features[0].residual_mm, 2.0e-3);
  }
}

class RealPegs : public RealFits {};
TEST_P(RealPegs, AWrongRadiusIsRefusedWithTheMeasuredOne) {
  const auto path = folder_ / "wrong.yaml";
  std::ofstream(path)
      << "name: w\nunits: mm\nparts:\n  - name: hole\n    mesh: {file: "
      << std::filesystem::absolute(data_folder() / "fits" / GetParam().hole_file).string()
      << ", unit: m}\n    features:\n      bore: {kind: cylinder, point: [0, 0, "
         "0], axis: [0, 0, 1], diameter: "
      << GetParam().hole_mm - 0.1 << ", inward: true}\n";
  const auto opened = open_scene(path);
  ASSERT_TRUE(opened);
  ASSERT_FALSE(opened->usable());
  const std::string text = opened->findings.back().text;
  const std::size_t at = text.find("the mesh has radius ");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(at + 20)), 0.5 * GetParam().hole_mm, 1.5e-3) << text;
}

TEST_P(RealFits, NothingIsRealAtThePoseNorAlongTheAxis) {
  OpenedScene opened = scene(0.0);
  World& world = opened.scene.world;
  const Vec3 assembled = world.parts[1].X_WP.p;
  const std::vector<double> lifts = gear() ? std::vector<double>{0.0, 2.0, 30.0}
                                           : std::vector<double>{-8.0, -3.0, 0.0, 4.0, 12.0};
  for (const double lift : lifts) {
    world.parts[1].X_WP.p = assembled + Vec3(0, 0, lift);
    world.state.reset();  // the part was put there, not moved
    for (const Verdict& v : judged(world))
      EXPECT_NE(v.collision_class, CollisionClass::kReal)
          << "lift " << lift << ": " << v.explanation;
  }
}

TEST_P(RealFits, TheMeasuredGapComesOut) {
  const double gap_mm = GetParam().gap_mm;
  OpenedScene opened = scene(gap_mm > 0.0 ? 0.7 * gap_mm : 0.0);
  World& world = opened.scene.world;
  CcdScratch ccd;
  const Part &a = world.parts[0], &b = world.parts[1];
  const DistanceResult apart = distance(*a.solid, a.X_WP, *b.solid, b.X_WP, ccd);
  EXPECT_NEAR(apart.distance_mm, gap_mm, 2e-3);
  if (gap_mm <= 0.0) return;
  // Tolerances that reach across the gap make it a potential collision, with the gap as its depth.
  const std::vector<Verdict> verdicts = judged(world, true);
  ASSERT_FALSE(verdicts.empty());
  const auto round = std::find_if(verdicts.begin(), verdicts.end(), [](const Verdict& v) {
    return v.face_a == "round" && v.face_b == "round";
  });
  ASSERT_NE(round, verdicts.end());
  EXPECT_EQ(round->collision_class, CollisionClass::kPotential);
  EXPECT_NEAR(-round->delta_mm.lo, gap_mm, 2e-3);
  // Exact surfaces give the stated clearance back, not that of the facets.
  const double stated_mm = 0.5 * std::fabs(GetParam().hole_mm - GetParam().part_mm);
  const double mesh_error_mm = -(round->fake_below_mm + 2.0 * 0.7 * gap_mm);
  EXPECT_NEAR(-round->delta_mm.hi - mesh_error_mm, stated_mm, 3e-3);
}

class FitWithoutClearance : public RealFits {};
TEST_P(FitWithoutClearance, TheGearOnItsShaftOfTheSameSizeIsNotReal) {
  OpenedScene opened = scene(0.0);
  const std::vector<Verdict> verdicts = judged(opened.scene.world);
  ASSERT_FALSE(verdicts.empty());  // the polygons do cross
  for (const Verdict& v : verdicts)
    EXPECT_NE(v.collision_class, CollisionClass::kReal) << v.explanation;
}

const auto name_of_fit = [](const auto& instance) { return std::string(instance.param.id); };
INSTANTIATE_TEST_SUITE_P(Published, RealFits, testing::ValuesIn(kFits), name_of_fit);
INSTANTIATE_TEST_SUITE_P(Published, RealPegs, testing::ValuesIn(kFits, kFits + 4), name_of_fit);
INSTANTIATE_TEST_SUITE_P(Published, FitWithoutClearance, testing::Values(kFits[5]), name_of_fit);

}  // namespace
}  // namespace mortise
