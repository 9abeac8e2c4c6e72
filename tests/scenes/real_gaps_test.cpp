// Published fits without round features: rectangular pegs in their holes and a nut on its bolt. The
// gap of the meshes is the published one, and nothing is called real, at the pose and along the
// axis.
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

fs::path fits_folder() { return test::data_folder() / "fits"; }

struct Gap {
  const char* name;
  const char* fixed_file;
  const char* moved_file;
  double z_mm;
  double gap_mm;  // measured by FCL, as published with the data
  double accuracy_mm;
};

constexpr Gap kGaps[] = {
    {"rect8_tight", "insertion/factory_rectangular_hole_8mm_subdiv_3x.obj",
     "insertion/factory_rectangular_peg_8mm_tight_subdiv_3x.obj", -10.0, 0.0670, 0.002},
    {"rect8_loose", "insertion/factory_rectangular_hole_8mm_subdiv_3x.obj",
     "insertion/factory_rectangular_peg_8mm_loose_subdiv_3x.obj", -10.0, 0.0900, 0.002},
    {"m16_loose", "nut_bolt/factory_bolt_m16_loose.obj",
     "nut_bolt/factory_nut_m16_loose_subdiv_3x.obj", 6.0, 0.101, 0.002}};

class RealGaps : public testing::TestWithParam<Gap> {};

TEST_P(RealGaps, TheGapIsThePublishedOneAndNothingIsReal) {
  MORTISE_NEEDS_DATA(fits_folder());
  Scenario scenario;
  scenario.name = GetParam().name;
  for (const char* file : {GetParam().fixed_file, GetParam().moved_file}) {
    Scenario::PartSpec part;
    part.name = file;
    part.mesh.file = fs::absolute(fits_folder() / file).string();
    part.mesh.unit_mm = 1000.0;
    scenario.parts.push_back(std::move(part));
  }
  scenario.parts[1].moving = true;
  scenario.parts[1].X_WP = Pose::translation(Vec3(0, 0, GetParam().z_mm));
  auto scene = load_scene(scenario, default_meshes());
  ASSERT_TRUE(scene) << scene.error().text;
  World& world = scene->world;
  CcdScratch scratch;
  const DistanceResult gap = distance(*world.parts[0].solid, world.parts[0].X_WP,
                                      *world.parts[1].solid, world.parts[1].X_WP, scratch);
  EXPECT_NEAR(gap.distance_mm, GetParam().gap_mm, GetParam().accuracy_mm);

  const bool threaded = std::string(GetParam().name).starts_with("m16");
  Scratch work;
  for (const double lift : {0.0, 1.0, 3.0, 5.0}) {
    // A nut that rises by a share of the pitch of 2 mm turns by that share.
    world.parts[1].X_WP = Pose::translation(Vec3(0, 0, GetParam().z_mm + lift));
    if (threaded)
      world.parts[1].X_WP.q = Quat(Eigen::AngleAxisd(std::numbers::pi * lift, Vec3::UnitZ()));
    for (const PairVerdicts& pair : judge_world(world, work, false).pairs)
      for (const Verdict& verdict : pair.verdicts)
        EXPECT_NE(verdict.collision_class, CollisionClass::kReal) << lift << verdict.explanation;
  }
}

INSTANTIATE_TEST_SUITE_P(Published, RealGaps, testing::ValuesIn(kGaps),
                         [](const auto& gap) { return std::string(gap.param.name); });

}  // namespace
}  // namespace mortise
