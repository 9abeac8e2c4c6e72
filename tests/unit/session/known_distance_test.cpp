#include "common/session/memory/known_distance.h"
#include "common/ccd/distance.h"

#include <gtest/gtest.h>

#include <random>

#include "common/ccd/first_contact.h"
#include "common/math/rotation.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

struct KnownDistance : ::testing::Test {
  std::mt19937_64 rng{21};
  CcdScratch ccd;
  const Solid a{box_mesh(Vec3(-3, -0.5, -0.5), Vec3(5, 0.5, 0.5))};
  const Solid b{box_mesh(Vec3(-1, -1, -1), Vec3(1, 2, 3))};

  Vec3 any() {
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    const double x = u(rng), y = u(rng), z = u(rng);
    return {x, y, z};
  }
  Pose pose(double spread_mm) { return {rotation_exp(3.0 * any()), spread_mm * any()}; }
  // A motion from near X, of the size given.
  Motion near(const Pose& X, const Vec3& reference, double shift_mm, double turn_rad) {
    const auto moved = [&](const Pose& from) {
      const Quat q = rotation_exp(turn_rad * any()) * from.q;
      return Pose{q.normalized(), from * reference + shift_mm * any() - q * reference};
    };
    const Pose X0 = moved(X);
    return linear_motion(X0, moved(X0), reference);
  }
};

TEST_F(KnownDistance, IsNeverAboveTheDistanceAtAnyTime) {
  int useful = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WA = pose(20), X_WB = pose(20);
    PairMemo memo;
    remember_apart(memo, X_WA, X_WB, distance(a, X_WA, b, X_WB, ccd).distance_mm);
    // Both are carried far away together, then moved a little on their own.
    const Pose carry = i % 2 ? pose(1000) : Pose{};
    const double size = i % 3 == 0 ? 0.02 : 1.0;
    const MovingPair query{&a, &b, near(carry * X_WA, a.sphere().center_mm, 2 * size, 0.5 * size),
                           near(carry * X_WB, b.sphere().center_mm, 2 * size, 0.5 * size)};
    const double bound = apart_lower_bound_mm(memo, query);
    useful += bound > 0.0;
    for (int t = 0; t <= 8; ++t) {
      const double d =
          distance(a, query.motion_a.pose_at(t / 8.0), b, query.motion_b.pose_at(t / 8.0), ccd)
              .distance_mm;
      ASSERT_LE(bound, d) << i << " t " << t;
    }
  }
  EXPECT_GT(useful, 500);
}

TEST_F(KnownDistance, PartsCarriedTogetherSpendNothing) {
  PairMemo memo;
  const Pose X_WA = at(0, 0, 0), X_WB = at(0, 5, 0);
  remember_apart(memo, X_WA, X_WB, 2.0);
  const Vec3 far(100, 200, 300);
  const MovingPair query{
      &a, &b, linear_motion(X_WA, Pose::translation(far), a.sphere().center_mm),
      linear_motion(X_WB, Pose::translation(X_WB.p + far), b.sphere().center_mm)};
  EXPECT_NEAR(apart_lower_bound_mm(memo, query), 2.0, 1e-9);
}

TEST_F(KnownDistance, KnowsNothingBeforeTheFirstMeasurement) {
  const PairMemo memo;
  const MovingPair query{&a, &b, still_motion(at(0, 0, 0)), still_motion(at(50, 0, 0))};
  EXPECT_LT(apart_lower_bound_mm(memo, query), 0.0);
}

// A ball passes a tilted bar: their boxes meet all the way, they never come nearer than 3 mm. One
// question of first contact, then a distance now and then.
TEST(KnownDistanceInTicks, WhoPassesByIsMeasuredAndNotAsked) {
  SessionBuilder session(Policy::kStop);
  const UserId ada = session.join("ada");
  const Pose tilted{rotation_exp(Vec3(0, 0, 0.785)), Vec3(0, 0, 0)};
  session.add("bar", box_mesh(Vec3(-20, -2, -2), Vec3(20, 2, 2)), tilted, false);
  const PartId cube = session.add("cube", cube_mesh(2), at(0, -9, 0), true);
  session.grab(ada, cube);
  Scratch scratch;
  StepCounters sum;
  for (int i = 0; i < 60; ++i) {
    const StepReport report =
        play_tick(session.world, {session.push(ada, cube, Vec3(0.08, 0.08, 0))}, scratch);
    EXPECT_TRUE(report.events.empty());
    EXPECT_EQ(report.counters.pairs_budget + report.counters.pairs.out, 1U) << i;
    sum.first_contact_queries += report.counters.first_contact_queries;
    sum.distance_queries += report.counters.distance_queries;
  }
  EXPECT_EQ(sum.first_contact_queries, 1U);
  EXPECT_LE(sum.distance_queries, 10U);
  EXPECT_GE(sum.distance_queries, 2U);
}

// Far from every surface and yet inside: put there and moved in the same tick, it is seen.
TEST(KnownDistanceInTicks, WhoIsInsideIsNotTakenForFarApart) {
  SessionBuilder session(Policy::kReport);
  const UserId ada = session.join("ada");
  session.add("block", cube_mesh(40), at(0, 0, 0), false);
  const PartId cube = session.add("cube", cube_mesh(2), at(0, 0, 0), true);
  session.grab(ada, cube);
  Scratch scratch;
  session.world.find(cube)->X_WP = at(100, 0, 0);
  play_tick(session.world, {session.push(ada, cube, Vec3(-76, 0, 0))}, scratch);  // comes near
  play_tick(session.world, {session.push(ada, cube, Vec3(0.5, 0, 0))}, scratch);
  session.command(ada, cube, CommandKind::kReset);  // back into the middle
  const StepReport report =
      play_tick(session.world, {session.push(ada, cube, Vec3(0.1, 0, 0))}, scratch);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
}

}  // namespace
}  // namespace mortise
