#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/scenario/scene_load.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

fs::path large_part() { return test::data_folder() / "large" / "nist_ctc_02_defl_0.02mm.ply"; }

// A real part of 263,730 triangles: what is built beside the mesh, and what an instance of it
// costs.
TEST(LargePart, LoadsWithinItsBytesAndAHundredInstancesCostOne) {
  MORTISE_NEEDS_DATA(large_part());
  Scenario scenario;
  scenario.name = "large";
  for (int i = 0; i < 100; ++i) {
    Scenario::PartSpec part;
    part.name = "part_" + std::to_string(i);
    part.mesh.file = large_part().string();
    part.X_WP = Pose::translation(Vec3(0.0, 0.0, 2000.0 * i));
    scenario.parts.push_back(std::move(part));
  }
  const auto scene = load_scene(scenario, default_meshes());
  ASSERT_TRUE(scene) << scene.error().text;
  ASSERT_TRUE(scene->usable());
  ASSERT_EQ(scene->world.parts.size(), 100U);
  std::set<const Solid*> solids;
  for (const Part& part : scene->world.parts) solids.insert(part.solid.get());
  ASSERT_EQ(solids.size(), 1U);

  const Solid& solid = **solids.begin();
  EXPECT_GT(solid.mesh().triangles.size(), 260'000U);
  EXPECT_EQ(solid.derived_bytes(), 0U) << "nothing is built before it is asked for";
  CcdScratch scratch;
  const DistanceResult apart =
      distance(solid, scene->world.parts[0].X_WP, solid, scene->world.parts[1].X_WP, scratch);
  EXPECT_GT(apart.distance_mm, 0.0);
  solid.topology();
  const double bytes = static_cast<double>(solid.derived_bytes()) /
                       static_cast<double>(solid.mesh().triangles.size());
  std::printf("%zu triangles, %.1f bytes a triangle beyond the mesh\n",
              solid.mesh().triangles.size(), bytes);
  EXPECT_LE(bytes, 250.0);
  EXPECT_GT(bytes, 12.0)
      << "neighbours alone take three ids a triangle: the count forgets something";
}

}  // namespace
}  // namespace mortise
