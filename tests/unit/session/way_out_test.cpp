// The way out that a verdict tells: whose it is, what stands in it, and that it works.
#include "common/session/tick/way_out.h"

#include <gtest/gtest.h>

#include "common/session/tick/judge_world.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// Cube a stands 0.1 deep in the wall; it comes free towards -x.
struct CubeInWall {
  SessionBuilder session;
  PartId a, wall;
  explicit CubeInWall(bool a_moves = true, bool wall_moves = false) {
    a = session.add("a", cube_mesh(2.0), Pose::translation({-0.9, 0, 0}), a_moves);
    wall = session.add("wall", box_mesh({0, -9, -9}, {9, 9, 9}), Pose(), wall_moves);
  }
  PairVerdicts judged() {
    Scratch scratch;
    const JudgeReport report = judge_world(session.world, scratch, false);
    for (const PairVerdicts& pair : report.pairs)
      if (pair.a == a && pair.b == wall) return pair;
    return {};
  }
  Verdict worst() {
    const PairVerdicts pair = judged();
    return pair.verdicts.empty() ? Verdict() : pair.verdicts.front();
  }
};

TEST(WayOut, IsThatOfThePartThatIsHeldOrMayMove) {
  EXPECT_FALSE(CubeInWall(true, false).worst().separation_of_b);
  EXPECT_TRUE(CubeInWall(false, true).worst().separation_of_b);
  EXPECT_FALSE(CubeInWall(true, true).worst().separation_of_b);
  CubeInWall held(true, true);
  held.session.world.find(held.wall)->holder = UserId{1};
  const Verdict v = held.worst();
  EXPECT_TRUE(v.separation_of_b);
  EXPECT_NEAR(v.separation_translation_mm.x(), 0.1, 1e-6);
  EXPECT_NEAR(v.gpd_mm.hi, 0.1, 1e-6);
}

TEST(WayOut, TellsTheFirstPartThatStandsInIt) {
  struct Other {
    double edge_mm;
    Vec3 at;
  };
  const Other far{2.0, {-3.5, 0, 0}}, beside{2.0, {-0.9, 2, 0}}, near{2.0, {-2.97, 0.5, 0}},
      nearest{1.0, {-2.43, 0, 0}};
  const auto path = [](const std::vector<Other>& others) {
    CubeInWall scene;
    for (const Other& other : others)
      scene.session.add("other", cube_mesh(other.edge_mm), Pose::translation(other.at), false);
    const Verdict v = scene.worst();
    return std::pair(v.separation_path, v.separation_blocker.value);
  };
  EXPECT_EQ(path({}).first, SeparationPath::kFree);
  EXPECT_EQ(path({far}).first, SeparationPath::kFree);
  EXPECT_EQ(path({beside}).first, SeparationPath::kFree);  // touches, slides along it
  EXPECT_EQ(path({far, near}), std::pair(SeparationPath::kBlocked, 4U));
  EXPECT_EQ(path({near, nearest}), std::pair(SeparationPath::kBlocked, 4U));
  EXPECT_EQ(path({nearest, near}), std::pair(SeparationPath::kBlocked, 3U));
}

// A cube in the middle of a slab comes out to either side by 1.5 mm: to the side that is free.
TEST(WayOut, OfTwoThatAreAsLongIsTheOneThatIsFree) {
  const auto told = [](const std::vector<double>& sides) {
    SessionBuilder session;
    session.add("a", cube_mesh(1.0), Pose(), true);
    session.add("slab", box_mesh({-1, -9, -9}, {1, 9, 9}), Pose(), false);
    for (const double side : sides)
      session.add("other", cube_mesh(1.0), Pose::translation({2.2 * side, 0, 0}), false);
    Scratch scratch;
    const JudgeReport report = judge_world(session.world, scratch, false);
    return report.pairs.front().verdicts.front();
  };
  EXPECT_EQ(told({}).separation_path, SeparationPath::kFree);
  for (const double side : {1.0, -1.0}) {
    const Verdict v = told({side});
    EXPECT_EQ(v.separation_path, SeparationPath::kFree) << side;
    EXPECT_EQ(v.separation_way, SeparationWay::kNormal) << side;
    EXPECT_FALSE(v.separation_blocker) << side;
    EXPECT_NEAR(v.gpd_mm.hi, 1.5, 1e-6);
    EXPECT_NEAR(v.separation_translation_mm.x(), -1.5 * side, 1e-6);
  }
  // Where both are blocked what stands in the first is told.
  EXPECT_EQ(told({1.0, -1.0}).separation_path, SeparationPath::kBlocked);
}

// Faces of ±0.02 on both parts: 0.1 as modelled, 0.06 made smallest, 0.14 made largest; 0.05 apart
// nothing, and with ±0.03 at most 0.01. Told with full brackets only.
TEST(WayOut, IsBracketedByTheLeastAndTheLargestBodies) {
  const auto layers = [](double x_mm, double tolerance_mm, bool full) {
    SessionBuilder session;
    const PartId a = session.add("a", cube_mesh(2.0), Pose::translation({x_mm, 0, 0}), true);
    const PartId wall = session.add("wall", box_mesh({0, -9, -9}, {9, 9, 9}), Pose(), false);
    session.set_tolerance(a, tolerance_mm);
    session.set_tolerance(wall, tolerance_mm);
    Scratch scratch;
    const JudgeReport report = judge_world(session.world, scratch, full);
    return report.pairs.empty() ? LayerDepths() : report.pairs.front().layers;
  };
  const LayerDepths deep = layers(-0.9, 0.02, true), near = layers(-1.05, 0.03, true);
  ASSERT_TRUE(deep.least_mm && deep.largest_mm && near.least_mm && near.largest_mm);
  EXPECT_NEAR(deep.least_mm->lo, 0.06, 1e-6);
  EXPECT_NEAR(deep.least_mm->hi, 0.06, 1e-6);
  EXPECT_NEAR(deep.largest_mm->lo, 0.14, 1e-6);
  EXPECT_NEAR(deep.largest_mm->hi, 0.14, 1e-6);
  EXPECT_EQ(*near.least_mm, Interval{});
  EXPECT_NEAR(near.largest_mm->lo, 0.01, 1e-6);
  EXPECT_NEAR(near.largest_mm->hi, 0.01, 1e-6);
  EXPECT_FALSE(layers(-0.9, 0.02, false).least_mm);
  EXPECT_FALSE(layers(-1.05, 0.02, true).least_mm) << "nothing is told of parts that are apart";
}

TEST(WayOut, AppliedItFreesTheParts) {
  CubeInWall scene;
  const SeparatingMotion motion = way_out(scene.worst());
  ASSERT_TRUE(motion.moves());
  Part& part = *scene.session.world.find(scene.a);
  part.X_WP = motion.displacement() * part.X_WP;
  EXPECT_TRUE(scene.judged().verdicts.empty());
}

}  // namespace
}  // namespace mortise
