// The closed bracket of a round face in a hollow one against its slow twin: dense sampling of the
// convex face. Random sizes, widenings, tilts and pushes.
#include "common/depth/search/round_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/math/pose.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

struct Case {
  RoundFace convex, hollow;
};

Case random_case(std::mt19937_64& random, double most_tilt_rad) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Case c;
  const double radius = 2.0 + 100.0 * unit(random), length = radius * (0.5 + 3.0 * unit(random));
  const bool conical = unit(random) < 0.5;
  c.hollow.widening = conical ? 0.05 + 0.8 * unit(random) : 0.0;
  c.hollow.radius_mm = conical ? 0.0 : radius;
  const double z0 = conical ? radius / c.hollow.widening : 0.0;
  c.hollow.extent_mm = {z0, z0 + length};
  const double push = 0.003 * radius * (unit(random) - 0.5);
  c.convex = c.hollow;
  c.convex.radius_mm += conical ? 0.0 : push;
  c.convex.widening *= conical ? 1.0 + 1e-3 * (unit(random) - 0.5) : 1.0;
  c.convex.extent_mm = {z0 + length * (unit(random) - 0.5) * 0.5,
                        z0 + length * (0.8 + unit(random))};
  c.convex.extent_mm.lo = std::max(c.convex.extent_mm.lo, conical ? 0.1 * z0 : -length);
  // Turned about its middle, so that it stays in the hollow face.
  const double turn = 2.0 * std::numbers::pi * unit(random);
  const Vec3 about = most_tilt_rad * unit(random) * Vec3(std::cos(turn), std::sin(turn), 0.0);
  const Quat q = rotation_exp(about);
  const Vec3 middle(0, 0, z0 + 0.5 * length);
  c.convex.axis = q * Vec3::UnitZ();
  c.convex.point =
      middle - (z0 + 0.5 * length) * c.convex.axis +
      0.002 * radius * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
  return c;
}

double beyond(const RoundFace& hollow, const Vec3& x) {
  const Vec3 d = x - hollow.point;
  const double z = d.dot(hollow.axis);
  return ((d - z * hollow.axis).norm() - hollow.radius_at(z)) / std::hypot(1.0, hollow.widening);
}

// Largest distance beyond the wall at many points of the convex face between the hollow one's ends.
double sampled(const Case& c, double margin_mm, int around, int along) {
  double most = -std::numeric_limits<double>::infinity();
  const Vec3 e1 = c.convex.axis.unitOrthogonal(), e2 = c.convex.axis.cross(e1);
  for (int i = 0; i < around; ++i)
    for (int j = 0; j <= along; ++j) {
      const double angle = 2.0 * std::numbers::pi * i / around;
      const double t = c.convex.extent_mm.lo + c.convex.extent_mm.width() * j / along;
      const Vec3 x = c.convex.point + t * c.convex.axis +
                     c.convex.radius_at(t) * (std::cos(angle) * e1 + std::sin(angle) * e2);
      const double z = (x - c.hollow.point).dot(c.hollow.axis);
      if (z < c.hollow.extent_mm.lo - margin_mm || z > c.hollow.extent_mm.hi + margin_mm) continue;
      most = std::max(most, beyond(c.hollow, x));
    }
  return most;
}

// Far from fitting: tilted by up to a quarter of a radian, off by up to the radius.
Case far_case(std::mt19937_64& random) {
  Case c = random_case(random, 0.25);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  c.convex.point +=
      0.5 * c.convex.radius_at(c.convex.extent_mm.hi) * Vec3(unit(random), unit(random), 0.0);
  return c;
}

struct Played {
  int above_hi = 0, far_below_lo = 0, wide = 0;
};

Played play(double planted_mm) {
  std::mt19937_64 random(20);
  Played tally;
  for (int i = 0; i < test::effort(300); ++i) {
    const Case c = random_case(random, i % 3 == 0 ? 0.0 : 0.004);
    const double margin = i % 2 == 0 ? 0.0 : 0.05;
    const auto reach = round_reach(c.convex, c.hollow, margin, 1e-5);
    if (!reach) {
      ++tally.wide;
      continue;
    }
    const double most = sampled(c, margin, 720, 200) + planted_mm;
    tally.above_hi += most > reach->reach_mm.hi + 1e-9;
    // The samples miss the ends of the hollow face by up to a step.
    const double step = c.convex.extent_mm.width() / 200.0 * 0.01 + 1e-3;
    tally.far_below_lo += most + step < reach->reach_mm.lo;
    tally.wide += reach->reach_mm.width() > (margin > 0.0 ? 5e-3 : 1e-4);
    EXPECT_NEAR(beyond(c.hollow, reach->point), reach->reach_mm.lo, 1e-9);
  }
  return tally;
}

TEST(RoundPair, BracketHoldsAgainstDenseSampling) {
  const Played tally = play(0.0);
  EXPECT_EQ(tally.above_hi, 0);
  EXPECT_EQ(tally.far_below_lo, 0);
  EXPECT_EQ(tally.wide, 0);
}

TEST(RoundPair, APlantedFaultIsSeen) { EXPECT_GT(play(1e-3).above_hi, 0); }

TEST(RoundPair, BracketIsTightHoweverFarTheyAreFromFitting) {
  std::mt19937_64 random(21);
  int bounded = 0;
  for (int i = 0; i < test::effort(300); ++i) {
    const Case c = far_case(random);
    const auto reach = round_reach(c.convex, c.hollow, 0.0, 1e-5);
    if (!reach || !std::isfinite(reach->reach_mm.hi)) continue;
    ++bounded;
    EXPECT_LE(sampled(c, 0.0, 720, 200), reach->reach_mm.hi + 1e-9);
    EXPECT_LE(reach->reach_mm.width(), 1e-2);
  }
  EXPECT_GE(bounded, test::effort(300) * 9 / 10);
}

TEST(RoundPair, CoaxialAndEccentricShaftsAreExact) {
  const RoundFace hole{Vec3::Zero(), Vec3::UnitZ(), 10.0, 0.0, {0.0, 20.0}};
  RoundFace shaft{Vec3(0.03, 0.04, 0.0), Vec3::UnitZ(), 9.99, 0.0, {-5.0, 15.0}};
  const auto eccentric = round_reach(shaft, hole, 0.0, 1e-9);
  ASSERT_TRUE(eccentric);
  EXPECT_NEAR(eccentric->reach_mm.lo, 0.04, 1e-8);
  EXPECT_NEAR(eccentric->reach_mm.hi, 0.04, 1e-8);
  // Tilted about the middle of the hole: the end circle of the shaft meets the wall.
  const double tilt = 0.004, half = 12.5;
  shaft = {Vec3::Zero(), rotation_exp(Vec3(tilt, 0, 0)) * Vec3::UnitZ(), 9.95, 0.0, {-half, half}};
  const RoundFace long_hole{Vec3::Zero(), Vec3::UnitZ(), 10.0, 0.0, {-50.0, 50.0}};
  const auto tilted = round_reach(shaft, long_hole, 0.0, 1e-9);
  ASSERT_TRUE(tilted);
  EXPECT_NEAR(tilted->reach_mm.hi, 9.95 * std::cos(tilt) + half * std::sin(tilt) - 10.0, 1e-5);
}

TEST(RoundPair, FacesThatPassEachOtherReachNothing) {
  const RoundFace hole{Vec3::Zero(), Vec3::UnitZ(), 10.0, 0.0, {0.0, 20.0}};
  const RoundFace shaft{Vec3::Zero(), Vec3::UnitZ(), 9.0, 0.0, {30.0, 40.0}};
  const auto reach = round_reach(shaft, hole, 0.0, 1e-6);
  ASSERT_TRUE(reach);
  EXPECT_EQ(reach->reach_mm.hi, -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(round_reach({Vec3::Zero(), Vec3::UnitX(), 9.0, 0.0, {0, 1}}, hole, 0.0, 1e-6));
}

}  // namespace
}  // namespace mortise
