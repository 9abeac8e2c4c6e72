// The generalized depth of parts whose best known motions were found by long searches.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/depth/gpd/separation_search.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/way_out.h"

namespace mortise::bench {
namespace {

struct KnownWay {
  const char* name;
  double best_mm;      ///< the shortest motion of A that is known to part them
  double least_share;  ///< of it that no motion is shown to undercut
};

constexpr KnownWay kKnownWays[] = {{"blocks5um", 9.995, 0.9999999}, {"slab_bar", 5.2, 0.9999999},
                                   {"peg_tilt", 0.09526, 0.9},      {"key_turned", 0.17458, 0.5},
                                   {"dshaft", 0.370, 0.0},          {"4pins", 0.010158, 0.9},
                                   {"hooks", 8.000625, 0.999},        {"gears_close", 0.138145, 0.9}};

Verdict worst_of(World& world, bool full) {
  Scratch scratch;
  const JudgeReport report = judge_world(world, scratch, full);
  return report.pairs.empty() || report.pairs[0].verdicts.empty() ? Verdict()
                                                                  : report.pairs[0].verdicts[0];
}

TEST(GpdCases, AreAsShortAsTheBestKnown) {
  for (const KnownWay& known : kKnownWays) {
    SCOPED_TRACE(known.name);
    auto opened = open_scene(std::string(MORTISE_SOURCE_DIR) + "/tests/bench/gpd_cases/" +
                             known.name + ".yaml");
    ASSERT_TRUE(opened && opened->usable());
    World& world = opened->scene.world;
    const Verdict lazy = worst_of(world, false), full = worst_of(world, true);
    EXPECT_LE(lazy.gpd_mm.hi, 1.01 * known.best_mm);
    EXPECT_LE(full.gpd_mm.hi, lazy.gpd_mm.hi * (1.0 + 1e-12));
    EXPECT_GE(full.gpd_mm.lo, lazy.gpd_mm.lo * (1.0 - 1e-12));
    for (const Verdict& told : {lazy, full}) {
      EXPECT_GE(told.gpd_mm.lo, known.least_share * known.best_mm);
      EXPECT_LE(told.gpd_mm.lo, 1.0001 * known.best_mm);
      EXPECT_FALSE(told.separation_of_b);
      EXPECT_NE(told.separation_path, SeparationPath::kUnknown);
      // Applied, and judged again.
      const SeparatingMotion motion = way_out(told);
      Part& part = world.parts[0];
      const Pose before = part.X_WP;
      EXPECT_NEAR(longest_path_mm(*part.solid, before, motion), told.gpd_mm.hi,
                  1e-8 * told.gpd_mm.hi + 1e-12);
      part.X_WP = motion.displacement() * before;
      CcdScratch ccd;
      EXPECT_TRUE(
          gpd::is_apart(*part.solid, part.X_WP, *world.parts[1].solid, world.parts[1].X_WP, ccd));
      const Verdict after = worst_of(world, false);
      EXPECT_LE(after.delta_mm.lo, 0.0);
      EXPECT_NE(after.collision_class, CollisionClass::kReal);
      part.X_WP = before;
    }
  }
}

}  // namespace
}  // namespace mortise::bench
