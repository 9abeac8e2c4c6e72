// What the search for a depth spends its work on, at poses of a recorded session.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/depth/depth.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"

namespace mortise {
namespace {

class SearchWork : public testing::Test {
 protected:
  void SetUp() override {
    const auto reading =
        read_scenario(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios" / "gearbox.yaml");
    ASSERT_TRUE(reading) << reading.error().text;
    auto scene = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(scene) << scene.error().text;
    scene_ = std::move(*scene);
  }
  OverlapResult judge(const std::string& a, const Pose& X_WA, const std::string& b,
                      const Pose& X_WB, std::uint64_t work_cap) {
    const Part* part_a = scene_.world.find_part(a);
    const Part* part_b = scene_.world.find_part(b);
    OverlapQuery query;
    query.a = part_a->solid.get();
    query.b = part_b->solid.get();
    query.band_a = &part_a->band;
    query.band_b = &part_b->band;
    query.X_WA = {X_WA.q.normalized(), X_WA.p};
    query.X_WB = {X_WB.q.normalized(), X_WB.p};
    query.work_cap = work_cap;
    return find_overlap(query, scratch_);
  }

  LoadedScene scene_;
  CcdScratch scratch_;
};

/// A dowel lies against a tooth of the gear with one end, and along its face 0.2 mm apart with the
/// other. The end that interferes is known early; what work is left is for the other one.
TEST_F(SearchWork, IsForTheRegionThatIsOpen) {
  const struct {
    Pose gear, dowel;
  } poses[] = {
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
  constexpr std::uint64_t kWork = 1'681;  // what the tick had for it
  for (const auto& [gear, dowel] : poses) {
    const OverlapResult found = judge("gear_out", gear, "dowel_2", dowel, kWork);
    ASSERT_FALSE(found.regions.empty());
    for (const OverlapRegion& region : found.regions) EXPECT_FALSE(region.capped);
    EXPECT_GT(found.regions.front().certain_mm.lo, 0.0);
    EXPECT_LT(found.evaluations, kWork);
  }
}

/// A tooth at the edge of a pocket: the zone in which the corners of the layer may lie is as wide
/// as it is, into however many pieces the faces are cut.
TEST_F(SearchWork, IsNotForPiecesThatNoCutMakesSmaller) {
  const Pose cover{
      Quat(0.99561047332056452, 0.045265729543754837, -0.058026004116190272, -0.057825444136477701),
      {-197.67259472914526, -16.084395806822744, 135.13384713017024}};
  const Pose gear{
      Quat(0.97416604957385688, 0.036403537162607566, -0.22208640204993194, 0.01878617481640649),
      {-148.61571581118804, -6.1733106018889412, 119.76307356550133}};
  constexpr std::uint64_t kWork = 4'333;
  const OverlapResult found = judge("cover", cover, "gear_in", gear, kWork);
  ASSERT_EQ(found.regions.size(), 1U);
  EXPECT_FALSE(found.regions.front().capped);
  EXPECT_GT(found.regions.front().possible_mm.lo, 0.0);
  EXPECT_LE(found.regions.front().certain_mm.hi, 0.0);
  EXPECT_LT(found.evaluations, kWork);
}

}  // namespace
}  // namespace mortise
