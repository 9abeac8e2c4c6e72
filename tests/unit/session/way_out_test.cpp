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
