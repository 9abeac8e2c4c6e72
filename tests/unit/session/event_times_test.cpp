// When a tick's events become possible and real, and that trembling is no news.
#include <gtest/gtest.h>

#include "common/evaluation/band.h"
#include "common/session/tick/judge_world.h"
#include "tests/support/shapes.h"
#include "tests/unit/depth/depth_bands.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

using Kind = ClashEvent::Kind;

// A cube of 10 mm whose right face stands at x, and a wall that begins at 0.
struct BlocksAt {
  explicit BlocksAt(double x_mm, double tolerance_mm, Policy policy = Policy::kReport)
      : session(policy) {
    ada = session.join("ada");
    wall = session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(20, 50, 50)), at(0, 0, 0), false);
    cube = session.add("cube", cube_mesh(10), at(x_mm - 5, 0, 0), true);
    if (tolerance_mm > 0.0)
      for (const PartId part : {wall, cube}) session.set_tolerance(part, tolerance_mm);
    session.grab(ada, cube);
  }
  StepReport push(double x_mm) {
    return play_tick(session.world, {session.push(ada, cube, Vec3(x_mm, 0, 0))}, scratch);
  }
  SessionBuilder session;
  Scratch scratch;
  UserId ada;
  PartId wall, cube;
};

// From a gap of 1 mm, 2 mm in a tick, each face within +-0.05: possible where 0.1 is left, contact
// of the meshes where nothing is, real 0.1 behind it.
TEST(EventTimes, OfBlocksWithTolerances) {
  BlocksAt s(-1.0, 0.05);
  const StepReport report = s.push(2.0);
  ASSERT_EQ(report.events.size(), 1U);
  const ClashEvent& event = report.events[0];
  EXPECT_EQ(event.verdict.collision_class, CollisionClass::kReal);
  EXPECT_NEAR(event.t_potential, 0.45, 1e-4);
  EXPECT_NEAR(event.t_contact, 0.50, 1e-6);
  EXPECT_NEAR(event.t_real, 0.55, 1e-4);
  EXPECT_GT(report.counters.event_time_queries, 0U);
}

TEST(EventTimes, NeverIsTold) {
  BlocksAt s(-1.0, 0.05);  // ends with the meshes 0.05 apart
  const StepReport report = s.push(0.95);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kPotential);
  EXPECT_NEAR(report.events[0].t_potential, 0.9 / 0.95, 1e-4);
  EXPECT_EQ(report.events[0].t_real, kNever);
  EXPECT_EQ(report.events[0].t_contact, 1.0);
}

TEST(EventTimes, WithoutTolerancesAllThreeAreOne) {
  BlocksAt s(-1.0, 0.0);
  const StepReport report = s.push(2.0);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_NEAR(report.events[0].t_contact, 0.5, 1e-6);
  EXPECT_NEAR(report.events[0].t_potential, 0.5, 1e-6);
  EXPECT_NEAR(report.events[0].t_real, 0.5, 1e-6);
  EXPECT_EQ(report.counters.event_time_queries, 0U);  // first contact knows it
}

// Stopped where it would become real; the event says where the increments would have led.
TEST(EventTimes, OfAStoppedMove) {
  BlocksAt s(-1.0, 0.05, Policy::kStop);
  const StepReport report = s.push(2.0);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_NEAR(report.events[0].t_potential, 0.45, 1e-4);
  EXPECT_NEAR(report.events[0].t_real, 0.55, 1e-3);
  EXPECT_NEAR(s.session.pose(s.cube).p.x() + 5.0, 0.1, 2e-3);
}

// Passing through a wall of 1 um within the tick: all of it happened, and is told.
TEST(EventTimes, OfAThinWall) {
  SessionBuilder session(Policy::kReport);
  const UserId ada = session.join("ada");
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(1e-3, 50, 50)), at(0, 0, 0), false);
  const PartId cube = session.add("cube", cube_mesh(1), at(-5.2995, 0, 0), true);
  session.grab(ada, cube);
  Scratch scratch;
  const StepReport report =
      play_tick(session.world, {session.push(ada, cube, Vec3(20, 0, 0))}, scratch);
  ASSERT_EQ(report.events.size(), 2U);
  EXPECT_NEAR(report.events[0].t_real, 0.239975, 1e-6);
}

// What is there already is there at 0.
TEST(EventTimes, OfWhatStandsSo) {
  BlocksAt s(0.2, 0.05);
  const StepReport report = play_tick(s.session.world, {}, s.scratch);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].t_potential, 0.0);
  EXPECT_EQ(report.events[0].t_real, 0.0);
}

// 20 H7/g6, pushed 30 um aside in its bore within one tick: the fit leaves 3.5 um at least and 20.5
// at most, whatever the meshes of 32 facets say, which overlap all the time.
TEST(EventTimes, OfAPegPushedAsideInItsBore) {
  const shapes::FitOffsets g6 = shapes::fit_offsets("H7/g6", 10.0);
  SessionBuilder session(Policy::kReport);
  const UserId ada = session.join("ada");
  const PartId plate =
      session.add("plate", shapes::ring({10, 0, 20, 32, 1, 0}, 20), at(0, 0, 0), false);
  const PartId peg = session.add("peg", shapes::peg({10, 0, 30, 32, 1, std::numbers::pi / 32}),
                                 at(0, 0, -5), true);
  Part* parts[2] = {session.world.find(plate), session.world.find(peg)};
  parts[0]->band = shapes::cylinder_band(parts[0]->solid, 10, true, g6.hole_mm);
  parts[1]->band = shapes::cylinder_band(parts[1]->solid, 10, false, g6.shaft_mm);
  session.world.evaluates = true;
  session.grab(ada, peg);
  Scratch scratch;
  StepReport report = play_tick(session.world, {}, scratch);
  ASSERT_EQ(report.events.size(), 1U);  // as it stands: fake
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kFake);
  EXPECT_EQ(report.events[0].t_potential, kNever);
  report = play_tick(session.world, {session.push(ada, peg, Vec3(0.03, 0, 0))}, scratch);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  EXPECT_NEAR(0.03 * report.events[0].t_potential, 0.0035, 2e-4);
  EXPECT_NEAR(0.03 * report.events[0].t_real, 0.0205, 2e-4);
}

// Two fine balls come into each other within one tick. The search for the first time at which they
// may interfere ends at its cap. The clash is told all the same: it is no pair that was not
// examined.
TEST(EventTimes, AtTheLatestAreCounted) {
  SessionBuilder session(Policy::kReport);
  const UserId ada = session.join("ada");
  const TriangleMesh ball = shapes::sphere(20.0, Vec3::Zero(), 50);
  const Vec3 aside = Vec3(1, 0, -0.7).normalized();
  const PartId still = session.add("still", ball, at(0, 0, 0), false);
  const PartId pushed = session.add("pushed", ball, Pose::translation(42.5 * aside), true);
  for (const PartId part : {still, pushed}) session.set_tolerance(part, 0.02);
  session.grab(ada, pushed);
  Scratch scratch;
  StepReport report;
  for (int i = 0; i < 4; ++i)
    report = play_tick(session.world, {session.push(ada, pushed, -0.7 * aside)}, scratch);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  EXPECT_EQ(report.counters.event_times_at_latest, 1U);
  EXPECT_EQ(report.counters.not_examined, 0U);
  EXPECT_TRUE(report.unexamined.empty());
  // Of the true balls: possible at a distance of 40.04. The time told is not earlier than that.
  EXPECT_GE(report.events[0].t_potential, (40.4 - 40.04) / 0.7);
  EXPECT_LE(report.events[0].t_potential, report.events[0].t_real);
}

// Ticks of +-amplitude about a place; how many events that makes.
std::size_t events_of_trembling(double x_mm, double tolerance_mm, double amplitude_mm,
                                int ticks = 1000) {
  BlocksAt s(x_mm - amplitude_mm, tolerance_mm);
  std::size_t events = play_tick(s.session.world, {}, s.scratch).events.size();
  for (int i = 0; i < ticks; ++i) {
    const double to = x_mm + (i % 2 == 0 ? amplitude_mm : -amplitude_mm) - 5.0;
    events += s.push(to - s.session.pose(s.cube).p.x()).events.size();
  }
  return events;
}

// Thresholds of two blocks with +-0.05: potential from a gap of 0.1, real from an overlap of 0.1.
// There it is told as potential, as real, and as not real any more: three events, then none.
TEST(Hysteresis, AThousandTremblingTicksAreOneEventAThreshold) {
  for (const double threshold : {-0.1, 0.1}) {
    const std::size_t most = threshold > 0.0 ? 3 : 2;
    EXPECT_LE(events_of_trembling(threshold, 0.05, 1e-4), most) << threshold;
    // Within 1 % of the width between the thresholds, 2 um, but not beyond 1 um.
    EXPECT_LE(events_of_trembling(threshold, 0.05, 4e-4, 100), most) << threshold;
    // What really goes to and fro is told each time.
    EXPECT_GT(events_of_trembling(threshold, 0.05, 5e-3, 50), 45U) << threshold;
  }
  EXPECT_LE(events_of_trembling(0.0, 0.0, 1e-4), 2U);
  EXPECT_GT(events_of_trembling(0.0, 0.0, 5e-3, 50), 45U);
}

// Each of the three classes of 20 H7/g6: pushed aside to where the class changes, trembling there.
// Real is told once, and left once.
TEST(Hysteresis, AFitTremblingAtItsThresholds) {
  const shapes::FitOffsets g6 = shapes::fit_offsets("H7/g6", 10.0);
  for (const double aside : {0.0035, 0.0205}) {
    SessionBuilder session(Policy::kReport);
    const UserId ada = session.join("ada");
    const PartId plate =
        session.add("plate", shapes::ring({10, 0, 20, 32, 1, 0}, 20), at(0, 0, 0), false);
    const PartId peg = session.add("peg", shapes::peg({10, 0, 30, 32, 1, std::numbers::pi / 32}),
                                   at(aside, 0, -5), true);
    Part* parts[2] = {session.world.find(plate), session.world.find(peg)};
    parts[0]->band = shapes::cylinder_band(parts[0]->solid, 10, true, g6.hole_mm);
    parts[1]->band = shapes::cylinder_band(parts[1]->solid, 10, false, g6.shaft_mm);
    session.world.evaluates = true;
    session.grab(ada, peg);
    Scratch scratch;
    std::size_t events = play_tick(session.world, {}, scratch).events.size();
    for (int i = 0; i < 100; ++i) {
      const double to = aside + (i % 2 == 0 ? 1e-4 : -1e-4);
      events +=
          play_tick(session.world,
                    {session.push(ada, peg, Vec3(to - session.pose(peg).p.x(), 0, 0))}, scratch)
              .events.size();
    }
    EXPECT_GE(events, 1U);
    EXPECT_LE(events, aside > 0.01 ? 3U : 2U) << aside;
  }
}

// Nothing declared, nothing round: no deviation, no tolerance, no band is looked at, and the
// counters say so. One declared part is enough for its own pairs.
TEST(Skipping, WithoutTolerancesNoBandIsLookedAt) {
  BlocksAt plain(-1.0, 0.0), banded(-1.0, 0.05);
  const StepCounters a = plain.push(2.0).counters, b = banded.push(2.0).counters;
  EXPECT_GT(a.judged_plain, 0U);
  EXPECT_EQ(a.judged_with_bands, 0U);
  EXPECT_EQ(a.event_time_queries, 0U);
  EXPECT_EQ(a.first_contact_queries, 1U);  // no second question for the band
  EXPECT_EQ(b.judged_plain, 0U);
  EXPECT_GT(b.judged_with_bands, 0U);
  EXPECT_EQ(a.regions_decided_early + a.regions_refined, a.verdicts.in);
}

// Far beyond a threshold the class is decided while the depth is still a wide bracket; on demand
// all are refined, or named as not examined to the end.
TEST(Skipping, DecidedEarlyAndRefinedAreCounted) {
  SessionBuilder session(Policy::kReport);
  Scratch scratch;
  const PartId parts[] = {
      session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(20, 50, 50)), at(0, 0, 0), false),
      session.add("ring", shapes::ring({5, -4, 4, 32, 2, 0}, 10), at(-7, 0, 0), true)};
  for (const PartId part : parts) session.set_tolerance(part, 0.05);
  const StepCounters lazy = judge_world(session.world, scratch, false).counters;
  const StepCounters full = judge_world(session.world, scratch, true).counters;
  EXPECT_EQ(lazy.regions_decided_early + lazy.regions_refined, lazy.verdicts.in);
  EXPECT_GT(lazy.regions_decided_early, 0U);
  EXPECT_EQ(full.regions_decided_early, 0U);
  EXPECT_EQ(full.regions_refined + full.not_examined, full.verdicts.in);
  EXPECT_LE(lazy.depth_evaluations, full.depth_evaluations);
}

}  // namespace
}  // namespace mortise
