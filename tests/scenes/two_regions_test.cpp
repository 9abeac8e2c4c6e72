// A dowel lies against a tooth of the gear with one end, and along its face 0.2 mm apart with the
// other: poses of a session. The end that interferes is known early; what work is left is for the
// other one.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/depth/overlap.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"

namespace mortise {
namespace {

struct Poses {
  Pose gear, dowel;
};

const Poses kPoses[] = {
    {{Quat(0.99982042198108212, -0.0019476181204264333, -0.0078752393586258955,
           -0.017126329970912051),
      {61.759059763942275, 159.37682102660008, 98.886804890041006}},
     {Quat(0.80194690335110796, 0.079172713491576299, -0.31251412455249616, 0.50293912911915728),
      {62.45470652143981, 209.73904911551992, 103.25384064764931}}},
    {{Quat(0.99981024614118452, -0.0017772658700510977, -0.0065381928544113463,
           -0.018263763887260687),
      {61.405777604616077, 159.26610054274749, 98.682909572558856}},
     {Quat(0.8013252175669604, 0.07842044387130559, -0.31770925791512555, 0.50078833563623582),
      {62.415009158142752, 209.71984010915452, 103.15771318186069}}}};

TEST(TwoRegions, TheOneThatIsOpenGetsTheWork) {
  const auto reading =
      read_scenario(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios" / "gearbox.yaml");
  ASSERT_TRUE(reading) << reading.error().text;
  const auto scene = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(scene) << scene.error().text;
  const Part* gear = scene->world.find_part("gear_out");
  const Part* dowel = scene->world.find_part("dowel_2");
  ASSERT_TRUE(gear != nullptr && dowel != nullptr);
  CcdScratch scratch;
  for (const Poses& poses : kPoses) {
    OverlapQuery query;
    query.a = gear->solid.get();
    query.b = dowel->solid.get();
    query.band_a = &gear->band;
    query.band_b = &dowel->band;
    query.X_WA = {poses.gear.q.normalized(), poses.gear.p};
    query.X_WB = {poses.dowel.q.normalized(), poses.dowel.p};
    query.work_cap = 1'681;  // what the tick had for it
    const OverlapResult found = find_overlap(query, scratch);
    ASSERT_FALSE(found.regions.empty());
    for (const OverlapRegion& region : found.regions) EXPECT_FALSE(region.capped);
    EXPECT_GT(found.regions.front().certain_mm.lo, 0.0);
    EXPECT_LT(found.evaluations, query.work_cap);
  }
}

}  // namespace
}  // namespace mortise
