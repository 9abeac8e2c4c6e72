// Several held parts that are moved as one.
#include <gtest/gtest.h>

#include "common/math/rotation.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

struct Group : ::testing::Test {
  SessionBuilder session{Policy::kStop};
  Scratch scratch;
  UserId ada = session.join("ada");
  PartId a = session.add("a", cube_mesh(2), at(0, 0, 5), true);
  PartId b = session.add("b", cube_mesh(2), at(2, 0, 5), true);  // faces coincide
  PartId c = session.add("c", cube_mesh(1), at(0, 3, 4), true);

  Group() {
    for (const PartId part : {a, b, c}) {
      session.grab(ada, part);
      session.world.find(part)->group = GroupId{1};
    }
  }
  Pose between(PartId x, PartId y) const { return session.pose(x).inverse() * session.pose(y); }
  StepReport push(PartId part, const Vec3& by, const Vec3& turn = Vec3::Zero()) {
    return play_tick(session.world, {session.push(ada, part, by, turn)}, scratch);
  }
};

TEST_F(Group, OneIncrementMovesAllAboutTheirCommonPoint) {
  const Pose ab = between(a, b), ac = between(a, c);
  Vec3 middle = Vec3::Zero();
  for (const PartId part : {a, b, c}) middle += session.pose(part).p / 3.0;
  const StepReport report = push(b, Vec3(1, 2, 3), Vec3(0, 0, 1.0));
  EXPECT_EQ(report.moved.size(), 3U);
  Vec3 now = Vec3::Zero();
  for (const PartId part : {a, b, c}) now += session.pose(part).p / 3.0;
  EXPECT_LT((now - middle - Vec3(1, 2, 3)).norm(), 1e-12);
  for (int i = 0; i < 200; ++i) push(i % 2 ? a : c, Vec3(0.1, -0.1, 0.05), Vec3(0.02, 0.01, -0.03));
  EXPECT_LT((between(a, b).p - ab.p).norm(), 1e-10);
  EXPECT_LT((between(a, c).p - ac.p).norm(), 1e-10);
  EXPECT_LT(between(a, b).q.angularDistance(ab.q), 1e-12);
}

TEST_F(Group, OneIsStoppedAllAre) {
  session.add("floor", box_mesh(Vec3(-50, -50, -2), Vec3(50, 50, 0)), Pose{}, false);
  const Pose ab = between(a, b), ac = between(a, c);
  const StepReport report = push(a, Vec3(0, 0, -8), Vec3(0.1, 0.2, 0));
  EXPECT_EQ(report.counters.stopped_parts, 3U);
  EXPECT_LT((between(a, b).p - ab.p).norm(), 1e-9);
  EXPECT_LT((between(a, c).p - ac.p).norm(), 1e-9);
}

TEST_F(Group, ASlideKeepsThemTogether) {
  session.world.policy = Policy::kSlide;
  session.add("floor", box_mesh(Vec3(-50, -50, -2), Vec3(50, 50, 0)), Pose{}, false);
  const Pose ab = between(a, b), ac = between(a, c);
  for (int i = 0; i < 10; ++i) push(b, Vec3(1, 0.5, -1));
  EXPECT_NEAR(session.pose(a).p.x(), 10.0, 1e-4);
  EXPECT_NEAR(session.pose(c).p.z(), 0.5, 1e-4);
  EXPECT_LT((between(a, b).p - ab.p).norm(), 1e-9);
  EXPECT_LT((between(a, c).p - ac.p).norm(), 1e-9);
}

TEST_F(Group, AReleasedPartLeaves) {
  session.command(ada, c, CommandKind::kRelease);
  EXPECT_FALSE(session.world.find(c)->group);
  push(a, Vec3(1, 0, 0));
  EXPECT_EQ(session.pose(c).p, Vec3(0, 3, 4));
  EXPECT_LT((session.pose(b).p - Vec3(3, 0, 5)).norm(), 1e-12);
}

}  // namespace
}  // namespace mortise
