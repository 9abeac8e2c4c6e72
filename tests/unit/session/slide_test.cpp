// Policy slide: what is left of a push after a real contact goes on along the contact.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/ccd/first_contact.h"
#include "common/math/rotation.h"
#include "tests/support/shapes.h"
#include "tests/unit/session/report_digest.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// What a slide may lie off the tangent: the lift off the contact and the accuracy of its place.
constexpr double kOff_mm = 1e-5;

/// The same scene anywhere in space.
struct Scene {
  SessionBuilder session{Policy::kSlide};
  Scratch scratch;
  UserId ada = session.join("ada");
  Pose X_WF;  ///< frame in which the scene is written

  explicit Scene(const Pose& X = {}) : X_WF(X) {}
  PartId wall(const Vec3& lo, const Vec3& hi) {
    return session.add(std::string("wall").append(std::to_string(session.world.parts.size())),
                       box_mesh(lo, hi), X_WF, false);
  }
  PartId mover(const TriangleMesh& mesh, const Vec3& at_F) {
    const PartId part = session.add("mover", mesh, X_WF * Pose::translation(at_F), true);
    session.grab(ada, part);
    return part;
  }
  StepReport push(PartId part, const Vec3& by_F, const Vec3& turn_F = Vec3::Zero()) {
    return play_tick(session.world, {session.push(ada, part, X_WF.q * by_F, X_WF.q * turn_F)},
                     scratch);
  }
  Vec3 place(PartId part) const { return X_WF.inverse() * session.pose(part).p; }
};

std::vector<Pose> frames() {
  std::vector<Pose> frames{Pose{}};
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int i = 0; i < 12; ++i) {
    const Vec3 turn(u(rng), u(rng), u(rng)), shift(u(rng), u(rng), u(rng));
    frames.push_back({rotation_exp(3.0 * turn), (i < 6 ? 100.0 : 5000.0) * shift});
  }
  return frames;
}

#define EXPECT_PLACE(part, x, y, z) \
  EXPECT_LT((s.place(part) - Vec3(x, y, z)).norm(), kOff_mm) << s.place(part).transpose()

TEST(Slide, BlockOnAFloorGlidesByTheTangentialPart) {
  for (const Pose& X : frames()) {
    Scene s(X);
    s.wall({-50, -50, -2}, {50, 50, 0});
    const PartId block = s.mover(cube_mesh(2), {0, 0, 1.5});
    const StepReport report = s.push(block, {3, 1, -2});
    EXPECT_PLACE(block, 3, 1, 1);
    EXPECT_EQ(report.counters.slid_parts, 1U);
    EXPECT_EQ(report.counters.stopped_parts, 0U);
    ASSERT_EQ(report.events.size(), 1U);  // what was prevented is told all the same
    EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
    EXPECT_NEAR(report.events[0].t_contact, 0.25, 1e-6);
    // And again from contact, for a long time.
    for (int i = 0; i < 30; ++i) s.push(block, {0.1, -0.2, -0.3});
    EXPECT_PLACE(block, 6, -5, 1);
  }
}

TEST(Slide, AStraightPushIsAStop) {
  for (const Pose& X : frames()) {
    Scene s(X);
    s.wall({-50, -50, -2}, {50, 50, 0});
    const PartId block = s.mover(cube_mesh(2), {0, 0, 1.5});
    const StepReport report = s.push(block, {0, 0, -2});
    EXPECT_PLACE(block, 0, 0, 1);
    EXPECT_EQ(report.counters.stopped_parts, 1U);
    EXPECT_EQ(report.counters.slide_legs, 0U);
  }
}

TEST(Slide, TwoWallsLeaveTheirEdgeAndACornerStops) {
  for (const Pose& X : frames()) {
    Scene s(X);
    s.wall({-50, -50, -2}, {50, 50, 0});
    s.wall({5, -50, 0}, {7, 50, 20});
    const PartId block = s.mover(cube_mesh(2), {0, 0, 2});
    s.push(block, {10, 2, -3});  // into the edge along y
    EXPECT_PLACE(block, 4, 2, 1);
    s.push(block, {1, 3, -1});
    EXPECT_PLACE(block, 4, 5, 1);
  }
  for (const Pose& X : frames()) {
    Scene s(X);
    s.wall({-50, -50, -2}, {50, 50, 0});
    s.wall({5, -50, 0}, {7, 50, 20});
    s.wall({-50, 8, 0}, {50, 9, 20});
    const PartId block = s.mover(cube_mesh(2), {0, 0, 2});
    s.push(block, {10, 20, -8});
    EXPECT_PLACE(block, 4, 7, 1);
    const StepReport report = s.push(block, {1, 1, -1});
    EXPECT_PLACE(block, 4, 7, 1);
    EXPECT_EQ(report.counters.stopped_parts, 1U);
  }
}

TEST(Slide, PastTheEndOfAWallTheWholePushCountsAgain) {
  Scene s;
  s.wall({0, -50, -50}, {10, 3, 50});
  const PartId block = s.mover(cube_mesh(2), {-1.5, 0, 0});
  // In contact at x = -1, along y to 4 (its lower edge at the wall's end), then on as pushed.
  const StepReport report = s.push(block, {8, 8, 0});
  EXPECT_GE(report.counters.slide_legs, 2U);
  const Vec3 at = s.place(block);
  EXPECT_NEAR(at.y(), 8.0, kOff_mm);
  EXPECT_GT(at.x(), 2.0);
}

TEST(Slide, ASphereGoesAroundACylinder) {
  for (const Pose& X : frames()) {
    Scene s(X);
    s.session.add("post", shapes::peg({10.0, -30.0, 30.0, 48}), s.X_WF, false);
    const PartId ball = s.mover(shapes::sphere(3.0, Vec3::Zero(), 12), {-20, 1.0, 0});
    for (int i = 0; i < 85; ++i) s.push(ball, {1.0, 0, 0});
    const Vec3 at = s.place(ball);
    EXPECT_GT(at.x(), 15.0) << at.transpose();
    EXPECT_GT(at.y(), 12.9) << at.transpose();
    EXPECT_NEAR(at.z(), 0.0, 1.0);
  }
}

// A plate of four pieces around a square hole of 4.02 mm, a peg of 4 mm.
PartId plate_and_peg(Scene& s) {
  s.wall({-50, -50, -10}, {-2.01, 50, 0});
  s.wall({2.01, -50, -10}, {50, 50, 0});
  s.wall({-2.01, -50, -10}, {2.01, -2.01, 0});
  s.wall({-2.01, 2.01, -10}, {2.01, 50, 0});
  return s.mover(box_mesh({-2, -2, 0}, {2, 2, 8}), {-6.123, 0.003, 1});
}

TEST(Slide, APegDraggedOverAPlateDropsIntoItsBore) {
  for (const Pose& X : frames()) {
    Scene s(X);
    const PartId peg = plate_and_peg(s);
    for (int i = 0; i < 60; ++i) s.push(peg, {0.3, 0, -0.3});
    EXPECT_LT(s.place(peg).z(), -5.0) << s.place(peg).transpose();
    EXPECT_NEAR(s.place(peg).x(), 0.01, 1e-4);
  }
  // Under stop it stays where it first touched.
  Scene s;
  s.session.world.policy = Policy::kStop;
  const PartId peg = plate_and_peg(s);
  for (int i = 0; i < 60; ++i) s.push(peg, {0.3, 0, -0.3});
  EXPECT_NEAR(s.place(peg).z(), 0.0, 1e-4);
  EXPECT_LT(s.place(peg).x(), -4.0);
}

TEST(Slide, ATurnGivesWayAsWell) {
  Scene s;
  s.wall({-50, -50, -2}, {50, 50, 0});
  const PartId bar = s.mover(box_mesh({-10, -1, -1}, {10, 1, 1}), {0, 0, 1.1});
  for (int i = 0; i < 10; ++i) s.push(bar, {0, 0, -0.05}, {0, 0.02, 0});
  // It lies on the floor, turned about the edge that touches, none of it below.
  double lowest = 1e9;
  for (const Vec3& x : s.session.world.find(bar)->solid->mesh().points_mm)
    lowest = std::min(lowest, (s.session.pose(bar) * x).z());
  EXPECT_GT(lowest, -2.0 * kAccuracyDefault_mm);
  EXPECT_LT(lowest, 1e-2);
  EXPECT_GT(rotation_log(s.session.pose(bar).q).norm(), 0.02);
}

TEST(Slide, TwoMoversKeepOffEachOther) {
  Scene s;
  const UserId bob = s.session.join("bob");
  const PartId left = s.mover(cube_mesh(2), {-5, 0, 0});
  const PartId right = s.session.add("right", cube_mesh(2), at(5, 0.5, 0), true);
  s.session.grab(bob, right);
  play_tick(
      s.session.world,
      {s.session.push(s.ada, left, Vec3(10, 1, 0)), s.session.push(bob, right, Vec3(-10, -1, 0))},
      s.scratch);
  const Vec3 a = s.session.pose(left).p, b = s.session.pose(right).p;
  EXPECT_GT(b.x() - a.x(), 2.0 - 2.0 * kAccuracyDefault_mm);
  EXPECT_NEAR(a.y(), 1.0, kOff_mm);
  EXPECT_NEAR(b.y(), -0.5, kOff_mm);
}

// With bands the search for the time at which a pair becomes real may end a leg before its time: it
// gets on, and not deeper.
TEST(Slide, WithBandsItGetsOnWhereEvenTheLeastPartsTouch) {
  for (const Pose& X : frames()) {
    Scene s(X);
    const PartId floor = s.wall({-50, -50, -2}, {50, 50, 0});
    const PartId block = s.mover(cube_mesh(2), {0, 0, 1.5});
    s.session.set_tolerance(floor, 0.02);
    s.session.set_tolerance(block, 0.03);
    const StepReport report = s.push(block, {3, 1, -2});
    EXPECT_EQ(report.counters.slid_parts, 1U);
    // Real from 0.05 mm on, what the tolerances may take away; stop leaves it at x = 0.825.
    EXPECT_GT(s.place(block).x(), 1.5) << s.place(block).transpose();
    EXPECT_NEAR(s.place(block).z(), 0.95, 2e-3);
    EXPECT_GE(s.place(block).z(), 0.95 - 1e-4);
  }
}

TEST(Slide, TheSameAtOneAndTwoThreads) {
  Scratch one(1), two(2);
  Scene a, b;
  const PartId peg_a = plate_and_peg(a), peg_b = plate_and_peg(b);
  for (int i = 0; i < 25; ++i) {
    const Vec3 by(0.3, 0.01 * (i % 3 - 1), -0.3), turn(0, 0, 0.001 * (i % 5 - 2));
    const StepReport x = play_tick(a.session.world, {a.session.push(a.ada, peg_a, by, turn)}, one);
    const StepReport y = play_tick(b.session.world, {b.session.push(b.ada, peg_b, by, turn)}, two);
    ASSERT_EQ(digest(x), digest(y)) << i;
  }
}

}  // namespace
}  // namespace mortise
