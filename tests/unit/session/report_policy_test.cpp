// Policy report: parts go where they are asked to go; every collision is told.
#include <gtest/gtest.h>

#include <numbers>

#include "common/evaluation/band.h"
#include "common/session/tick/judge_world.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

using Kind = ClashEvent::Kind;

struct ReportPolicy : ::testing::Test {
  SessionBuilder session{Policy::kReport};
  Scratch scratch;
  UserId ada = session.join("ada");

  StepReport tick(const std::vector<Increment>& increments) {
    return play_tick(session.world, increments, scratch);
  }
};

bool no_geometry(const StepCounters& c) {
  return c.pairs.out == 0 && c.first_contact_queries == 0 && c.distance_queries == 0 &&
         c.depth_queries == 0 && c.box_tests == 0 && c.triangle_tests == 0 &&
         c.depth_evaluations == 0;
}

void expect_balanced(const StepCounters& c) {
  std::uint64_t refused = 0;
  for (const std::uint64_t n : c.refused) refused += n;
  EXPECT_EQ(c.increments.in, c.increments.out + refused);
  EXPECT_EQ(c.moves.in, c.moves.out + c.moves_below_rounding);
  EXPECT_EQ(c.pairs.in, c.pairs.out + c.pairs_static + c.pairs_still + c.pairs_excluded +
                            c.pairs_boxes_apart + c.pairs_budget);
  EXPECT_EQ(c.contacts.in, c.contacts.out + c.contacts_clear + c.contacts_undecided);
  EXPECT_EQ(c.contacts.in, c.pairs.out);
}

// Nothing is said of its surface: the mesh is taken for it.
TEST_F(ReportPolicy, APartThatNobodyGaveABandIsItsMesh) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  for (Part& part : session.world.parts) part.band = SurfaceBand{};
  session.grab(ada, peg);
  const StepReport report = tick({session.push(ada, peg, Vec3(5, 0, 0))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  EXPECT_NEAR(report.events[0].verdict.delta_mm.lo, 1.0, 1e-3);
}

// What a scenario approves it approves of where its parts start, and no deeper.
TEST_F(ReportPolicy, AnOverlapAtTheStartCanBeApprovedByTheScenario) {
  const PartId wall =
      session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(0, 0, 0), true);
  const PartId other = session.add("other", cube_mesh(2), at(0, 20, 0), true);
  session.world.approved_at_start[{wall, peg}] = "a thread";
  const StepReport start = tick({});
  ASSERT_EQ(start.events.size(), 2U);
  EXPECT_EQ(start.events[0].review.status, ReviewStatus::kApproved);
  EXPECT_EQ(start.events[0].review.comment, "a thread");
  EXPECT_FALSE(start.events[0].approval_lost);
  EXPECT_EQ(start.events[1].part_b, other);
  EXPECT_EQ(start.events[1].review.status, ReviewStatus::kNew);
  session.grab(ada, peg);
  const StepReport deeper = tick({session.push(ada, peg, Vec3(0.5, 0, 0))});
  ASSERT_EQ(deeper.events.size(), 1U);
  EXPECT_TRUE(deeper.events[0].approval_lost);
  tick({session.push(ada, peg, Vec3(-20, 0, 0))});
  const StepReport again = tick({session.push(ada, peg, Vec3(19.5, 0, 0))});
  ASSERT_EQ(again.events.size(), 1U);
  EXPECT_EQ(again.events[0].kind, Kind::kBegin);
  EXPECT_EQ(again.events[0].review.status, ReviewStatus::kNew);
}

// Through the open side of a bin no surface is met on the way in; what is in it is not called free.
TEST_F(ReportPolicy, WhatMayLieInAnOpenPartIsCountedEveryTick) {
  TriangleMesh bin = box_mesh(Vec3(-20, -20, -20), Vec3(20, 20, 20));
  std::erase_if(bin.triangles, [&](const auto& t) {
    return bin.points_mm[t[0]].z() + bin.points_mm[t[1]].z() + bin.points_mm[t[2]].z() > 50.0;
  });
  const PartId open = session.add("bin", bin, at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(0, 0, 30), true);
  ASSERT_FALSE(session.world.find(open)->solid->has_inside());
  session.grab(ada, peg);
  EXPECT_EQ(tick({session.push(ada, peg, Vec3(0, 0, -1))}).counters.not_examined, 0U);
  for (int i = 0; i < 4; ++i) {
    const StepReport report = tick({session.push(ada, peg, Vec3(0, 0, i == 0 ? -25 : 1))});
    expect_balanced(report.counters);
    EXPECT_TRUE(report.events.empty());
    EXPECT_EQ(report.counters.not_examined, 1U) << i;
  }
  const JudgeReport judged = judge_world(session.world, scratch, false);
  ASSERT_EQ(judged.pairs.size(), 1U);
  EXPECT_TRUE(judged.pairs[0].not_examined);
}

// Its edge comes out farther than its faces, and is looked at from there on.
TEST_F(ReportPolicy, AnOpenPartReachesAsFarAsItsEdges) {
  TriangleMesh open = cube_mesh(10);
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);  // without its bottom
  const Pose on_edge{Quat(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitZ())), Vec3::Zero()};
  const PartId block = session.add("block", open, on_edge, false);
  const double gap_mm = 0.115, x = 5.0 + 5.0 * std::numbers::sqrt2 + gap_mm;
  const PartId wall = session.add("wall", cube_mesh(10), at(x + 2, 0.3, 0.2), true);
  for (const PartId id : {block, wall}) {
    BandInput input;
    input.solid = session.world.find(id)->solid.get();
    input.rest = {{-0.05, 0.05}, "±0.05 mm"};
    session.world.find(id)->band = build_band(input);
  }
  session.world.evaluates = true;
  session.grab(ada, wall);
  const StepReport report = tick({session.push(ada, wall, Vec3(-2, 0, 0))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kPotential);
}

// Overlap within the rounding of two files is never told as real.
TEST_F(ReportPolicy, RoundingOfFilesIsNotReal) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  for (Part& part : session.world.parts) {
    part.band.faces[0].deviation_mm = {-1e-3, 1e-3};
    part.band.quantum_mm = part.band.largest_offset_mm = 1e-3;
  }
  session.grab(ada, peg);
  const StepReport slight = tick({session.push(ada, peg, Vec3(4.001, 0, 0))});
  ASSERT_EQ(slight.events.size(), 1U);
  EXPECT_EQ(slight.events[0].verdict.collision_class, CollisionClass::kPotential);
  EXPECT_GT(slight.events[0].t_real, 1.0);
  const StepReport deep = tick({session.push(ada, peg, Vec3(1, 0, 0))});
  ASSERT_FALSE(deep.events.empty());
  EXPECT_EQ(deep.events.back().verdict.collision_class, CollisionClass::kReal);
}

TEST_F(ReportPolicy, ABandOfAnotherPartIsRefusedWithASentence) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.world.find(peg)->band.face_of_triangle = {0, 0, 1};
  EXPECT_DEATH(tick({}), "a band has a face for every triangle");
  session.world.find(peg)->band.face_of_triangle = {};
  session.world.find(peg)->band.faces.clear();
  EXPECT_DEATH(tick({}), "a band has a face for every triangle");
}

TEST_F(ReportPolicy, PegIntoWallBeginsChangesEnds) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.grab(ada, peg);
  StepReport report = tick({session.push(ada, peg, Vec3(3, 0, 0))});
  EXPECT_TRUE(report.events.empty());
  expect_balanced(report.counters);

  report = tick({session.push(ada, peg, Vec3(2, 0, 0))});  // 1 mm deep
  ASSERT_EQ(report.events.size(), 1U);
  const ClashEvent begin = report.events[0];
  EXPECT_EQ(begin.kind, Kind::kBegin);
  EXPECT_EQ(begin.seq, 1U);
  EXPECT_EQ(begin.tick, 2U);
  EXPECT_EQ(begin.user, ada);
  EXPECT_EQ(begin.part_a.value, 1U);
  EXPECT_EQ(begin.part_b, peg);
  EXPECT_EQ(begin.verdict.collision_class, CollisionClass::kReal);
  EXPECT_NEAR(begin.verdict.delta_mm.lo, 1.0, 1e-3);
  EXPECT_NEAR(begin.t_contact, 0.5, 1e-6);
  EXPECT_FALSE(begin.verdict.explanation.empty());
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 0));
  expect_balanced(report.counters);

  report = tick({});
  EXPECT_TRUE(report.events.empty());
  ASSERT_EQ(snapshot_of(session.world).open_clashes.size(), 1U);

  report = tick({session.push(ada, peg, Vec3(-3, 0, 0))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kEnd);
  EXPECT_EQ(report.events[0].clash, begin.clash);
  EXPECT_EQ(report.events[0].seq, 2U);
  EXPECT_EQ(report.events[0].begin_tick, 2U);
  EXPECT_NEAR(report.events[0].worst_delta_mm.lo, 1.0, 1e-3);
  EXPECT_TRUE(snapshot_of(session.world).open_clashes.empty());
}

TEST_F(ReportPolicy, DeeperAndDeeperIsOneClashWithFewEvents) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(100, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(20), at(-11, 0, 0), true);
  session.grab(ada, peg);
  std::uint64_t begins = 0, changes = 0, ends = 0, seq = 0;
  for (int i = 0; i < 90; ++i) {
    const StepReport report = tick({session.push(ada, peg, Vec3(0.1, 0, 0))});
    for (const ClashEvent& event : report.events) {
      EXPECT_EQ(event.seq, ++seq);
      begins += event.kind == Kind::kBegin;
      changes += event.kind == Kind::kChange;
      ends += event.kind == Kind::kEnd;
    }
  }
  EXPECT_EQ(begins, 1U);
  EXPECT_EQ(ends, 0U);
  EXPECT_GE(changes, 1U);
  EXPECT_LE(changes, 6U);  // 80 ticks in contact, a quarter of a second apart
}

TEST_F(ReportPolicy, RestingInContactSaysNothingAndCostsNothing) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.grab(ada, peg);
  std::uint64_t begins = 0, others = 0;
  StepReport report = tick({session.push(ada, peg, Vec3(4.2, 0, 0))});
  begins += report.events.size();
  for (int i = 0; i < 600; ++i) {
    report = tick({});
    others += report.events.size();
    EXPECT_TRUE(no_geometry(report.counters));
    expect_balanced(report.counters);
  }
  EXPECT_EQ(begins, 1U);
  EXPECT_EQ(others, 0U);
}

TEST_F(ReportPolicy, ThinWallPassedWithinOneTickIsTold) {
  for (const double thickness_mm : {1.0, 1e-3}) {
    SessionBuilder s(Policy::kReport);
    const UserId user = s.join("ada");
    s.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(thickness_mm, 50, 50)), at(0, 0, 0), false);
    const PartId peg = s.add("peg", cube_mesh(1), at(-5.2995, 0, 0), true);
    s.grab(user, peg);
    Scratch own;
    play_tick(s.world, {}, own);
    const StepReport report = play_tick(s.world, {s.push(user, peg, Vec3(20, 0, 0))}, own);
    EXPECT_EQ(s.pose(peg).p.x(), 20 - 5.2995);
    ASSERT_EQ(report.events.size(), 2U) << thickness_mm;
    EXPECT_EQ(report.events[0].kind, Kind::kBegin);
    EXPECT_EQ(report.events[1].kind, Kind::kEnd);
    EXPECT_EQ(report.events[0].clash, report.events[1].clash);
    EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
    EXPECT_NEAR(report.events[0].t_contact, 0.239975, 1e-6);
    EXPECT_TRUE(snapshot_of(s.world).open_clashes.empty());
    // The disease: looking at the target alone sees nothing.
    EXPECT_TRUE(judge_world(s.world, own, false).pairs.empty());
  }
}

TEST_F(ReportPolicy, GrazingPastIsNoClash) {
  session.add("block", cube_mesh(2), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-10, 2, 0), true);  // faces in one plane
  session.grab(ada, peg);
  const StepReport report = tick({session.push(ada, peg, Vec3(20, 0, 0))});
  for (const ClashEvent& event : report.events)
    EXPECT_NE(event.verdict.collision_class, CollisionClass::kReal);
}

TEST_F(ReportPolicy, InitialOverlapIsToldByTheFirstTick) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  session.add("peg", cube_mesh(2), at(0, 0, 0), true);
  StepReport report = tick({});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kBegin);
  EXPECT_FALSE(report.events[0].user);
  EXPECT_EQ(report.events[0].t_contact, 0.0);
  report = tick({});
  EXPECT_TRUE(report.events.empty());
  EXPECT_TRUE(no_geometry(report.counters));
}

TEST_F(ReportPolicy, TeleportsBeginAndEndClashes) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-30, 0, 0), true);
  session.grab(ada, peg);
  tick({session.push(ada, peg, Vec3(30, 0, 0))});
  ASSERT_EQ(snapshot_of(session.world).open_clashes.size(), 1U);
  EXPECT_EQ(session.command(ada, peg, CommandKind::kReset).refusal, Refusal::kNone);
  StepReport report = tick({});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kEnd);
  EXPECT_EQ(session.command(ada, peg, CommandKind::kUndo).refusal, Refusal::kNone);
  report = tick({});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kBegin);
}

TEST_F(ReportPolicy, ExcludedPairsAreNeverAsked) {
  const PartId wall =
      session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-2, 0, 0), true);
  PairRule rule;
  rule.a = wall;
  rule.b = peg;
  rule.excluded = true;
  rule.reason = "press fit, accepted";
  session.world.pair_rules[{wall, peg}] = rule;
  session.grab(ada, peg);
  const StepReport report = tick({session.push(ada, peg, Vec3(3, 0, 0))});
  EXPECT_TRUE(report.events.empty());
  EXPECT_EQ(report.counters.pairs_excluded, 1U);
  EXPECT_TRUE(no_geometry(report.counters));
  expect_balanced(report.counters);
  const JudgeReport judged = judge_world(session.world, scratch, false);
  ASSERT_EQ(judged.pairs.size(), 1U);
  EXPECT_TRUE(judged.pairs[0].excluded);
}

TEST_F(ReportPolicy, ToleranceBandMakesANearPairPotential) {
  const PartId wall =
      session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.set_tolerance(wall, 0.05);
  session.set_tolerance(peg, 0.05);
  session.grab(ada, peg);
  StepReport report = tick({session.push(ada, peg, Vec3(3.8, 0, 0))});  // gap 0.2
  EXPECT_TRUE(report.events.empty());
  report = tick({session.push(ada, peg, Vec3(0.15, 0, 0))});  // gap 0.05
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kPotential);
  report = tick({session.push(ada, peg, Vec3(0.25, 0, 0))});  // overlap 0.2
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kChange);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  report = tick({session.push(ada, peg, Vec3(-0.4, 0, 0))});  // gap 0.2
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, Kind::kEnd);
  EXPECT_EQ(report.events[0].worst_class, CollisionClass::kReal);
}

// A class that trembles about its threshold must not be told sixty times a second.
TEST_F(ReportPolicy, TremblingAtTheThresholdIsQuiet) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.grab(ada, peg);
  tick({session.push(ada, peg, Vec3(4 + 2e-5, 0, 0))});
  std::uint64_t events = 0;
  for (int i = 0; i < 60; ++i)
    events += tick({session.push(ada, peg, Vec3(i % 2 ? 4e-5 : -4e-5, 0, 0))}).events.size();
  EXPECT_EQ(events, 0U);
}

// Where real is left, it is not told any more, however little it is left by; and trembling about
// the threshold is as quiet.
TEST_F(ReportPolicy, RealIsToldOnlyOfWhatIs) {
  const PartId wall =
      session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  const PartId peg = session.add("peg", cube_mesh(2), at(-5, 0, 0), true);
  session.set_tolerance(wall, 0.05);
  session.set_tolerance(peg, 0.05);
  session.grab(ada, peg);
  double overlap_mm = -4.0;
  const auto to = [&](double mm) {
    const double by = mm - overlap_mm;
    overlap_mm = mm;
    return tick({session.push(ada, peg, Vec3(by, 0, 0))}).events;
  };
  const auto expect_told = [&](const std::vector<ClashEvent>& events, CollisionClass told) {
    ASSERT_EQ(events.size(), 1U) << overlap_mm;
    EXPECT_EQ(events[0].verdict.collision_class, told) << overlap_mm;
  };
  expect_told(to(0.1005), CollisionClass::kReal);
  expect_told(to(0.0996), CollisionClass::kPotential);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(to(i % 2 ? 0.0996 : 0.1004).size(), 0U) << i;
  expect_told(to(0.103), CollisionClass::kReal);
  expect_told(to(0.0999), CollisionClass::kPotential);
  EXPECT_EQ(to(0.1004).size(), 0U);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(tick({}).events.size(), 0U) << i;
}

}  // namespace
}  // namespace mortise
