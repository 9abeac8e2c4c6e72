#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/depth/depth.h"
#include "common/evaluation/verdict.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct Sweep {
  SolidPtr a, b;
  SurfaceBand band_a = nominal_band(), band_b = nominal_band();
  Motion motion_a = still_motion(Pose()), motion_b = still_motion(Pose());
  double accuracy_mm = 1e-4;
};

Motion slide(const Vec3& from, const Vec3& to) {
  return linear_motion(Pose::translation(from), Pose::translation(to), Vec3::Zero());
}

SweptQuery swept_query(const Sweep& s) {
  SweptQuery query;
  query.at_target.a = s.a.get();
  query.at_target.b = s.b.get();
  query.at_target.band_a = &s.band_a;
  query.at_target.band_b = &s.band_b;
  query.motion_a = s.motion_a;
  query.motion_b = s.motion_b;
  query.accuracy_mm = s.accuracy_mm;
  return query;
}

InterferenceTime real_time_of(const Sweep& s) {
  CcdScratch scratch;
  return find_interference_time(swept_query(s), scratch);
}

PossibleTime possible_time_of(const Sweep& s) {
  CcdScratch scratch;
  return find_possible_time(swept_query(s), scratch);
}

// Lower bounds of what is certain and of what is possible.
Interval depths_at(const Sweep& s, double t) {
  OverlapQuery query;
  query.a = s.a.get();
  query.b = s.b.get();
  query.band_a = &s.band_a;
  query.band_b = &s.band_b;
  query.X_WA = s.motion_a.pose_at(t);
  query.X_WB = s.motion_b.pose_at(t);
  CcdScratch scratch;
  query.refinement = Refinement::kFull;
  Interval most{-1e9, -1e9};
  for (const OverlapRegion& region : find_overlap(query, scratch).regions) {
    most.lo = std::max(most.lo, region.certain_mm.lo);
    most.hi = std::max(most.hi, region.possible_mm.lo);
  }
  return most;
}

double certain_at(const Sweep& s, double t) { return depths_at(s, t).lo; }

TEST(InterferenceTime, CubeMeetsCube) {
  Sweep s{solid(box({.5, .5, .5}, Vec3::Zero(), 2)), solid(box({.5, .5, .5}, {5, .2, .1}, 2))};
  s.motion_a = slide(Vec3::Zero(), {10, 0, 0});
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_real, 0.4, 2e-5);
  EXPECT_LE(real.t_free, real.t_real);
  EXPECT_NEAR(real.t_free, 0.4, 2e-5);
  EXPECT_FALSE(real.real_at_start);
}

TEST(InterferenceTime, ToleranceDelaysIt) {
  Sweep s{solid(box({.5, .5, .5}, Vec3::Zero(), 2)), solid(box({.5, .5, .5}, {5, .2, .1}, 2))};
  s.band_a = s.band_b = uniform_band({}, {-.05, .05});
  s.motion_a = slide(Vec3::Zero(), {10, 0, 0});
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_free, 0.41, 2e-5);
  EXPECT_NEAR(real.t_real, 0.41, 2e-5);
}

// Faces 4 mm apart, 10 mm a tick, each within +-0.05: they may meet 0.1 early and must 0.1 late.
TEST(PossibleTime, TolerancesMeetBeforeTheMeshesDo) {
  Sweep s{solid(box({.5, .5, .5}, Vec3::Zero(), 2)), solid(box({.5, .5, .5}, {5, .2, .1}, 2))};
  s.band_a = s.band_b = uniform_band({}, {-.05, .05});
  s.motion_a = slide(Vec3::Zero(), {10, 0, 0});
  const PossibleTime possible = possible_time_of(s);
  EXPECT_TRUE(possible.becomes_possible);
  EXPECT_NEAR(possible.t_clear, 0.39, 2e-5);
  EXPECT_NEAR(possible.t_possible, 0.39, 2e-5);
  EXPECT_LE(possible.t_clear, possible.t_possible);
  // Ends with faces 0.15 apart: nothing can happen. With 0.05: it may, but need not.
  s.motion_a = slide(Vec3::Zero(), {3.85, 0, 0});
  EXPECT_FALSE(possible_time_of(s).becomes_possible);
  EXPECT_EQ(possible_time_of(s).t_clear, 1.0);
  s.motion_a = slide(Vec3::Zero(), {3.95, 0, 0});
  EXPECT_NEAR(possible_time_of(s).t_clear, 3.9 / 3.95, 5e-5);
  EXPECT_FALSE(real_time_of(s).becomes_real);
}

// 20 H7/g6; the meshes (32 facets, half a phase apart) overlap from the start and say nothing.
Sweep peg_in_its_fit() {
  const FitOffsets g6 = fit_offsets("H7/g6", 10.0);
  Sweep s;
  s.a = solid(peg({10, 0, 30, 32, 8, std::numbers::pi / 32}));
  s.b = solid(ring({10, 0, 20, 32, 8, 0}, 20));
  s.band_a = cylinder_band(s.a, 10, false, g6.shaft_mm);
  s.band_b = cylinder_band(s.b, 10, true, g6.hole_mm);
  return s;
}

// Pushed aside: its least clearance is 3.5 um, its largest 20.5.
TEST(PossibleTime, PegPushedAsideInItsFit) {
  Sweep s = peg_in_its_fit();
  s.motion_a = slide({0, 0, 5}, {0.03, 0, 5});
  const PossibleTime possible = possible_time_of(s);
  EXPECT_TRUE(possible.becomes_possible);
  EXPECT_NEAR(possible.t_clear * 0.03, 0.0035, 2e-4);
  EXPECT_NEAR(possible.t_possible * 0.03, 0.0035, 4e-4);
  // Slid along its axis, at rest in a fit that may interfere: at once.
  s.motion_a = slide({0, 0, 5}, {0, 0, 4});
  EXPECT_FALSE(possible_time_of(s).becomes_possible);
  const FitOffsets k6 = fit_offsets("H7/k6", 10.0);
  s.band_a = cylinder_band(s.a, 10, false, k6.shaft_mm);
  EXPECT_TRUE(possible_time_of(s).becomes_possible);
  EXPECT_EQ(possible_time_of(s).t_clear, 0.0);
}

TEST(PossibleTime, WithoutBandsItIsTheTimeOfTheMeshes) {
  Sweep s{solid(box({.5, .5, .5})), solid(box({.0005, 5, 5}, {10, 0, 0}))};
  s.motion_a = slide(Vec3::Zero(), {20, 0, 0});
  EXPECT_NEAR(possible_time_of(s).t_clear, 9.4995 / 20.0, 2e-5);
}

// The disease and the cure: both ends of the tick are free, the wall is in between.
TEST(InterferenceTime, ThinWallIsNotPassed) {
  Sweep s{solid(box({.5, .5, .5})), solid(box({.0005, 5, 5}, {10, 0, 0}))};
  s.motion_a = slide(Vec3::Zero(), {20, 0, 0});
  EXPECT_LT(certain_at(s, 0.0), 0.0);
  EXPECT_LT(certain_at(s, 1.0), 0.0);
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_free, 9.4995 / 20.0, 2e-5);
  EXPECT_LE(real.t_free, real.t_real);
}

// Meshes that overlap before: a peg with a fake overlap slides, and runs into the end of a blind
// hole.
TEST(InterferenceTime, BlindHoleBehindAFakeOverlap) {
  const FitOffsets g6 = fit_offsets("H7/g6", 10.0);
  Sweep s;
  s.a = solid(peg({10, 0, 15, 32, 1, std::numbers::pi / 32}));
  s.b = solid(together(ring({10, 0, 20, 32, 1, 0}, 20), box({15, 15, 1}, {0, 0, -2})));
  s.band_a = cylinder_band(s.a, 10, false, g6.shaft_mm);
  s.band_b = cylinder_band(s.b, 10, true, g6.hole_mm);
  s.motion_a = slide({0, 0, 2}, {0, 0, -3});
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_free, 0.6, 1e-4);
  s.motion_a = slide({0, 0, 2}, {0, 0, -0.9});
  EXPECT_FALSE(real_time_of(s).becomes_real);
  EXPECT_EQ(real_time_of(s).t_free, 1.0);
}

TEST(InterferenceTime, SlidingPegIsFreeAndCheap) {
  Sweep s = peg_in_its_fit();
  s.motion_a = slide({0, 0, 5}, {0, 0, 4});
  const InterferenceTime slid = real_time_of(s);
  EXPECT_FALSE(slid.becomes_real);
  EXPECT_EQ(slid.t_free, 1.0);
  EXPECT_LT(slid.evaluations, 5000U);
  // Pushed aside by 30 um it bites: 20.5 um of certain clearance at most.
  s.motion_a = slide({0, 0, 5}, {0.03, 0, 5});
  const InterferenceTime pushed = real_time_of(s);
  EXPECT_TRUE(pushed.becomes_real);
  EXPECT_NEAR(pushed.t_free * 0.03, 0.0205, 2e-4);
}

TEST(InterferenceTime, TurningBarMeetsCube) {
  // ccd/README.md, section 7: bar 4 x 0.2 x 0.2 turning 90 degrees against a 0.2 cube at (0, 1.5).
  Sweep s{solid(box({2, .1, .1})), solid(box({.1, .1, .1}, {0, 1.5, 0}))};
  s.motion_a = linear_motion(Pose(), Pose{rotation_exp({0, 0, std::numbers::pi / 2}), Vec3::Zero()},
                             Vec3::Zero());
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_free, 0.9092085160, 1e-4);
  EXPECT_NEAR(real.t_real, 0.9092085160, 1e-3);
}

TEST(InterferenceTime, TwoMovers) {
  Sweep s{solid(box({.5, .5, .5})), solid(box({.5, .5, .5}))};
  s.motion_a = slide(Vec3::Zero(), {2, 0, 0});
  s.motion_b = slide({4, .1, .2}, {2, .1, .2});
  const InterferenceTime real = real_time_of(s);
  EXPECT_TRUE(real.becomes_real);
  EXPECT_NEAR(real.t_free, 0.75, 1e-4);
  // Both with the same velocity: nothing happens.
  s.motion_b = slide({4, .1, .2}, {6, .1, .2});
  EXPECT_FALSE(real_time_of(s).becomes_real);
}

TEST(InterferenceTime, StartsRealOrTouching) {
  Sweep s{solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {.9, .1, .2}))};
  s.motion_a = slide(Vec3::Zero(), {-1, 0, 0});
  EXPECT_TRUE(real_time_of(s).real_at_start);
  EXPECT_EQ(real_time_of(s).t_free, 0.0);
  s.b = solid(box({.5, .5, .5}, {1, .1, .2}));
  s.motion_a = slide(Vec3::Zero(), {0, 3, 0});  // along the touching faces
  EXPECT_FALSE(real_time_of(s).becomes_real);
}

// A bar with a band that flies through a box at a random pose, turning.
Sweep random_flight(std::mt19937_64& random, const SurfaceBand& band_a, const SurfaceBand& band_b) {
  Sweep s{solid(box({1, .3, .2})), solid(box({.4, .6, .5}))};
  s.band_a = band_a;
  s.band_b = band_b;
  s.accuracy_mm = 1e-3;
  Pose from = random_pose(random, 1.0), to = random_pose(random, 1.0);
  from.p.x() -= 2.5;
  to.p.x() += 0.5;
  to.q = (rotation_exp(0.5 * rotation_log((to.q * from.q.conjugate()).normalized())) * from.q)
             .normalized();
  s.motion_a = linear_motion(from, to, Vec3::Zero());
  return s;
}

// Random motions: never possible before t_clear, by an independent query at many times; and in the
// order possible, then real. The check itself sees a planted fault.
TEST(PossibleTime, NeverPossibleBeforeClear) {
  std::mt19937_64 random(22);
  int became = 0, planted = 0;
  for (int i = 0; i < 12; ++i) {
    const Sweep s = random_flight(random, uniform_band({}, {-.01, .02}),
                                  uniform_band({-.005, .01}, {-.01, .01}));
    const PossibleTime possible = possible_time_of(s);
    EXPECT_FALSE(possible.capped);
    became += possible.becomes_possible;
    for (int k = 0; k < 20; ++k) {
      if (!test::plays(k, 3)) continue;
      EXPECT_LE(depths_at(s, possible.t_clear * k / 20.0).hi, s.accuracy_mm) << i;
    }
    if (possible.becomes_possible) {
      EXPECT_LT((possible.t_possible - possible.t_clear) * 6.0, 0.1) << i;
      EXPECT_LE(possible.t_clear, real_time_of(s).t_real) << i;
      planted += depths_at(s, std::min(1.0, possible.t_clear + 0.02)).hi > 0.0;
    }
  }
  EXPECT_GT(became, 4);
  EXPECT_GT(planted, 2);
}

// The same of what is real: never before t_free.
TEST(InterferenceTime, NeverRealBeforeFree) {
  std::mt19937_64 random(21);
  int became = 0, planted = 0;
  for (int i = 0; i < 12; ++i) {
    const Sweep s =
        random_flight(random, uniform_band({}, {-.01, .01}), uniform_band({}, {-.01, .01}));
    const InterferenceTime real = real_time_of(s);
    EXPECT_FALSE(real.capped);
    became += real.becomes_real;
    for (int k = 0; k < 20; ++k)
      EXPECT_LE(certain_at(s, real.t_free * k / 20.0), s.accuracy_mm) << i;
    EXPECT_LE(certain_at(s, real.t_free), 0.0) << i;
    if (real.becomes_real) {
      EXPECT_LT((real.t_real - real.t_free) * 6.0, 0.1) << i;
      planted += certain_at(s, std::min(1.0, real.t_free + 0.02)) > 0.0;
    }
  }
  EXPECT_GT(became, 4);
  EXPECT_GT(planted, 2);
}

}  // namespace
}  // namespace mortise
