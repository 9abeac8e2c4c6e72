// What holds for every session of policy stop, whatever users do. The judge of it here is the
// separating-axis test of boxes, written for this test and unknown to the engine.
#include <gtest/gtest.h>

#include "tests/support/box_overlap.h"
#include "tests/support/effort.h"
#include "tests/unit/session/random_play.h"

namespace mortise {
namespace {

TEST(StopProperty, NothingIsEverLeftOverlapping) {
  std::uint64_t stopped = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(12)); ++seed) {
    RandomPlay play(Policy::kStop, seed, 6, false);
    ASSERT_LT(deepest_overlap_mm(play.session.world), 0.0);
    Scratch scratch;
    for (int i = 0; i < 40; ++i) {
      stopped += play.tick(scratch).counters.stopped_parts;
      // Up to the accuracy of first contact is touching; twice that is where it says overlapping.
      ASSERT_LT(deepest_overlap_mm(play.session.world), 2.0 * kAccuracyDefault_mm)
          << "seed " << seed << " tick " << i;
    }
  }
  EXPECT_GT(stopped, 100U);
}

// With tolerances: nothing is left where even the least real parts overlap, up to the accuracy to
// which the search knows when they do (SweptQuery::accuracy_mm).
TEST(StopProperty, NothingIsEverLeftInterferingForCertain) {
  std::uint64_t stopped = 0;
  double deepest = -1e300;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RandomPlay play(Policy::kStop, seed, 6, true);
    Scratch scratch(2);
    for (int i = 0; i < 30; ++i) {
      stopped += play.tick(scratch).counters.stopped_parts;
      ASSERT_LT(deepest_overlap_mm(play.session.world, true), kDepthAccuracyDefault_mm)
          << "seed " << seed << " tick " << i;
      deepest = std::max(deepest, deepest_overlap_mm(play.session.world));
    }
  }
  EXPECT_GT(stopped, 20U);
  EXPECT_GT(deepest, 0.01);  // the meshes themselves may overlap, and do
}

// The same play without a policy does overlap: the property above is not empty.
TEST(StopProperty, WithoutThePolicyPartsDoOverlap) {
  RandomPlay play(Policy::kReport, 1, 6, false);
  Scratch scratch;
  double deepest = -1e300;
  for (int i = 0; i < 40; ++i) {
    play.tick(scratch);
    deepest = std::max(deepest, deepest_overlap_mm(play.session.world));
  }
  EXPECT_GT(deepest, 0.1);
}

// Whoever was stopped can go back the way it came.
TEST(StopProperty, TheWayBackIsFree) {
  std::uint64_t stopped = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(20)); ++seed) {
    RandomPlay play(Policy::kStop, seed, 1, false);
    const PartId part = play.movers[0];
    Scratch scratch;
    for (int i = 0; i < 20; ++i) {
      const Vec3 before = play.session.pose(part).p;
      const StepReport there = play_tick(
          play.session.world,
          {play.session.push(play.user_of(part), part, 6.0 * play.any() - Vec3(0, 0, 2))}, scratch);
      if (there.counters.stopped_parts == 0) continue;
      ++stopped;
      const Vec3 back = before - play.session.pose(part).p;
      const StepReport report = play_tick(
          play.session.world, {play.session.push(play.user_of(part), part, back)}, scratch);
      ASSERT_EQ(report.counters.stopped_parts, 0U) << "seed " << seed << " tick " << i;
      ASSERT_LT((play.session.pose(part).p - before).norm(), 1e-9);
    }
  }
  EXPECT_GT(stopped, 20U);
}

// The clashes that a session reports as open are the pairs that overlap, and no others.
TEST(ReportProperty, OpenClashesAreThePairsThatOverlap) {
  std::uint64_t overlapping = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(6)); ++seed) {
    RandomPlay play(Policy::kReport, seed, 6, false);
    Scratch scratch;
    scratch.impl().switches.work_budget = false;  // a pair that waits keeps its clash for a while
    for (int i = 0; i < 40; ++i) {
      play.tick(scratch);
      const Snapshot snapshot = snapshot_of(play.session.world);
      for (const Part& a : play.session.world.parts)
        for (const Part& b : play.session.world.parts) {
          if (a.id >= b.id || (!a.moving && !b.moving)) continue;
          if (a.id.value == kFrame || b.id.value == kFrame) continue;
          const double depth = box_overlap_mm(a, b);
          if (std::abs(depth) < 1e-3) continue;  // within hysteresis either is right
          const bool open = std::any_of(
              snapshot.open_clashes.begin(), snapshot.open_clashes.end(),
              [&](const ClashEvent& e) { return e.part_a == a.id && e.part_b == b.id; });
          ASSERT_EQ(open, depth > 0.0) << "seed " << seed << " tick " << i << " " << a.name << " "
                                       << b.name << " depth " << depth;
          overlapping += open;
        }
    }
  }
  EXPECT_GT(overlapping, 50U);
}

}  // namespace
}  // namespace mortise
