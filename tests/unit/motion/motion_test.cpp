#include "common/motion/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/math/rotation.h"
#include "tests/support/numbers.h"

namespace mortise {
namespace {

Pose pose(const Vec3& w, const Vec3& p) { return {rotation_exp(w), p}; }

Pose random_pose(std::mt19937_64& random, double largest_angle) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vec3 axis(unit(random), unit(random), unit(random));
  axis.normalize();
  return pose(axis * (largest_angle * unit(random)),
              10.0 * Vec3(unit(random), unit(random), unit(random)));
}

double difference(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() +
         std::min((a.q.coeffs() - b.q.coeffs()).norm(), (a.q.coeffs() + b.q.coeffs()).norm());
}

TEST(Motion, EndsAreExactToTheLastBit) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random, kPi), b = random_pose(random, kPi);
    for (const Motion& m : {linear_motion(a, b, {1, 2, 3}), screw_motion(a, b, {1, 2, 3})}) {
      EXPECT_TRUE(identical(m.pose_at(0.0), a));
      EXPECT_TRUE(identical(m.pose_at(1.0), b));
      // And the path arrives there.
      EXPECT_LT(difference(m.pose_at(std::nextafter(1.0, 0.0)), b), 1e-11);
      EXPECT_LT(difference(m.pose_at(1e-300), a), 1e-11);
    }
  }
}

TEST(Motion, ScrewLiftsAPointWhileItTurns) {
  // ccd/README.md, section 7: (1,0,0), half a turn about z with lift 2, is at y = 0.5, z = 1/3 at t
  // = 1/6.
  const Motion m = screw_motion({}, pose({0, 0, kPi}, {0, 0, 2}), Vec3::Zero());
  ASSERT_EQ(m.kind, PathKind::kScrew);
  const Vec3 x = m.pose_at(1.0 / 6.0) * Vec3(1, 0, 0);
  EXPECT_NEAR(x.y(), 0.5, 1e-14);
  EXPECT_NEAR(x.z(), 1.0 / 3.0, 1e-14);
}

TEST(Motion, ThePathIsPartOfTheContract) {
  // The same two poses, two paths. Middle of the origin: (1,0,0) and (1, 1 - sqrt 2, 0).
  const Pose end = pose({0, 0, kPi / 2}, {2, 0, 0});
  const Vec3 linear = linear_motion({}, end, Vec3::Zero()).pose_at(0.5).p;
  const Vec3 screw = screw_motion({}, end, Vec3::Zero()).pose_at(0.5).p;
  EXPECT_LT((linear - Vec3(1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((screw - Vec3(1, 1 - std::numbers::sqrt2, 0)).norm(), 1e-14);
}

TEST(Motion, ReferencePointMovesStraight) {
  const Pose end = pose({0.3, -0.2, 1.1}, {4, -1, 2});
  const Vec3 reference(5, 6, 7);
  const Motion m = linear_motion({}, end, reference);
  const Vec3 from = reference, to = end * reference;
  for (double t : {0.1, 0.37, 0.9})
    EXPECT_LT((m.pose_at(t) * reference - (from + t * (to - from))).norm(), 1e-13);
}

TEST(Motion, HalfATurnTakesADeterminedSide) {
  // At exactly pi the axis has its first component positive: +x goes to -x by way of +y about +z.
  Pose end;
  end.q = Quat(0, 0, 0, 1);
  for (const Quat& q : {Quat(0, 0, 0, 1), Quat(0, 0, 0, -1)}) {
    end.q = q;
    const Vec3 middle = linear_motion({}, end, Vec3::Zero()).pose_at(0.5) * Vec3(1, 0, 0);
    EXPECT_LT((middle - Vec3(0, 1, 0)).norm(), 1e-15);
  }
  const Motion nearly = linear_motion({}, pose({0, 0, -(kPi - 1e-12)}, {0, 0, 0}), Vec3::Zero());
  EXPECT_LT((nearly.pose_at(0.5) * Vec3(1, 0, 0) - Vec3(0, -1, 0)).norm(), 1e-12);
}

TEST(Motion, TravelBoundHoldsAlongTheWholePath) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Pose a = random_pose(random, kPi), b = random_pose(random, kPi);
    const Vec3 reference(unit(random), unit(random), unit(random));
    const Vec3 point = reference + 3.0 * Vec3(unit(random), unit(random), unit(random));
    for (const Motion& m : {linear_motion(a, b, reference), screw_motion(a, b, reference)}) {
      double length = 0.0;
      Vec3 last = m.pose_at(0.25) * point;
      for (int k = 1; k <= 500; ++k) {
        const Vec3 x = m.pose_at(0.25 + 0.5 * k / 500.0) * point;
        length += (x - last).norm();
        last = x;
      }
      const double bound = m.travel_upper_bound_mm((point - reference).norm(), 0.25, 0.75);
      EXPECT_LE(length, bound * (1 + 1e-12));
      EXPECT_GT(length, 0.05 * bound - 1e-3) << "a bound that says nothing";
    }
  }
}

// A turn of 0.1 rad at 10 mm: the arc is 1, its chord shorter; with a lift of 1 the arc is sqrt(2).
TEST(Motion, ArcsAndChords) {
  const Vec3 far_point(10, 0, 0);
  const Motion turn = linear_motion(Pose{}, pose({0, 0, 0.1}, Vec3::Zero()), Vec3::Zero());
  EXPECT_NEAR(turn.travel_upper_bound_mm(10.0, 0.0, 1.0), 1.0, 1e-15);
  EXPECT_NEAR((turn.X_W1 * far_point - turn.X_W0 * far_point).norm(), 0.999583385, 1e-9);
  const Motion lifted = screw_motion(Pose{}, pose({0, 0, 0.1}, {0, 0, 1}), Vec3::Zero());
  EXPECT_NEAR(lifted.travel_upper_bound_mm(10.0, 0.0, 1.0), std::numbers::sqrt2, 1e-12);
}

TEST(Motion, VelocityIsTheDerivativeOfThePath) {
  std::mt19937_64 random(13);
  for (int i = 0; i < 50; ++i) {
    const Pose a = random_pose(random, kPi), b = random_pose(random, kPi);
    const Vec3 reference(1, -2, 0.5);
    for (const Motion& m : {linear_motion(a, b, reference), screw_motion(a, b, reference)}) {
      const double t = 0.4, h = 1e-5;
      const Vec3 slope = (m.pose_at(t + h) * reference - m.pose_at(t - h) * reference) / (2.0 * h);
      EXPECT_LT((m.velocity_at(t) - slope).norm(), 1e-5 * (1.0 + slope.norm()));
    }
  }
}

TEST(Motion, SeenFromAStillFrameIsTheSamePath) {
  std::mt19937_64 random(14);
  for (int i = 0; i < 50; ++i) {
    const Pose a = random_pose(random, kPi), b = random_pose(random, kPi);
    const Pose X_WB = random_pose(random, kPi);
    for (const Motion& m : {linear_motion(a, b, {1, 0, 0}), screw_motion(a, b, {1, 0, 0})}) {
      const Motion seen = seen_from(m, X_WB);
      for (double t : {0.0, 0.2, 0.77, 1.0})
        EXPECT_LT(difference(X_WB * seen.pose_at(t), m.pose_at(t)), 1e-12);
    }
  }
}

TEST(Motion, CutShortItIsTheSamePathAndEndsExactly) {
  std::mt19937_64 random(15);
  for (int i = 0; i < 50; ++i) {
    const Pose a = random_pose(random, kPi), b = random_pose(random, kPi);
    for (const Motion& m : {linear_motion(a, b, {1, 0, 0}), screw_motion(a, b, {1, 0, 0})}) {
      const Motion cut = until(m, 0.3);
      EXPECT_TRUE(identical(cut.pose_at(1.0), m.pose_at(0.3)));
      for (double t : {0.0, 0.2, 0.77, 1.0})
        EXPECT_LT(difference(cut.pose_at(t), m.pose_at(0.3 * t)), 1e-12);
    }
  }
  EXPECT_FALSE(until(linear_motion({}, Pose::translation({1, 0, 0}), Vec3::Zero()), 0.0).moves());
}

TEST(Motion, AlmostStraightScrewKeepsItsDigits) {
  // The axis lies 1e9 mm away; a path computed by R r - r would be wrong by 1e-7 mm.
  for (double angle : {1e-6, 1e-8, 1e-10, 1e-14}) {
    const Pose end = pose({0, 0, angle}, {3, 4, 1});
    const Motion screw = screw_motion({}, end, Vec3::Zero());
    const Motion linear = linear_motion({}, end, Vec3::Zero());
    for (double t : {0.1, 0.5, 0.9}) {
      const double bulge = 5.0 * angle / 8.0;
      EXPECT_LT((screw.pose_at(t).p - linear.pose_at(t).p).norm(), bulge * 1.01 + 1e-14) << angle;
    }
  }
}

TEST(Motion, NothingMovesIsStill) {
  const Pose a = pose({1, 2, 0.1}, {1, 2, 3});
  EXPECT_FALSE(linear_motion(a, a, {1, 1, 1}).moves());
  EXPECT_FALSE(screw_motion(a, a, {1, 1, 1}).moves());
  EXPECT_EQ(still_motion(a).travel_upper_bound_mm(1e9, 0, 1), 0.0);
  // A pure translation turns by exactly nothing.
  const Motion slide = linear_motion(a, {a.q, a.p + Vec3(1, 0, 0)}, {1, 1, 1});
  EXPECT_TRUE(slide.w_W.isZero(0.0));
  EXPECT_EQ(screw_motion(a, {a.q, a.p + Vec3(1, 0, 0)}, {1, 1, 1}).kind, PathKind::kLinear);
}

}  // namespace
}  // namespace mortise
