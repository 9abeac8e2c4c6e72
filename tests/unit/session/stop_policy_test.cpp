// Policy stop: nobody is let into a real collision, and nobody is held without need.
#include <gtest/gtest.h>

#include <cmath>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// Overlaps up to the accuracy of first contact are touching.
constexpr double kTouch_mm = 1.1 * kAccuracyDefault_mm;

struct StopPolicy : ::testing::Test {
  SessionBuilder session{Policy::kStop};
  Scratch scratch;
  UserId ada = session.join("ada");
  UserId bob = session.join("bob");

  PartId wall() {
    return session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(10, 50, 50)), at(0, 0, 0), false);
  }
  PartId peg(double x) {
    const PartId part = session.add("peg", cube_mesh(2), at(x, 0, 0), true);
    session.grab(ada, part);
    return part;
  }
  StepReport tick(const std::vector<Increment>& increments) {
    return play_tick(session.world, increments, scratch);
  }
  double gap(PartId a, PartId b) {
    CcdScratch ccd;
    return distance(*session.world.find(a)->solid, session.pose(a), *session.world.find(b)->solid,
                    session.pose(b), ccd)
        .distance_mm;
  }
};

TEST_F(StopPolicy, MoverIsLeftInContact) {
  const PartId w = wall(), p = peg(-5);
  const StepReport report = tick({session.push(ada, p, Vec3(10, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -1.0, 2e-6);
  EXPECT_LE(session.pose(p).p.x(), -1.0);
  EXPECT_LT(gap(w, p), 2e-6);
  EXPECT_EQ(report.counters.stopped_parts, 1U);
  EXPECT_EQ(report.counters.rounds, 1U);
  // What was prevented is told: real, where the increment would have led.
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  EXPECT_NEAR(report.events[0].t_contact, 0.4, 1e-6);
  EXPECT_NE(report.events[0].verdict.explanation.find("stopped"), std::string::npos)
      << report.events[0].verdict.explanation;
}

TEST_F(StopPolicy, PushingAgainstAWallForALongTimeIsOneClash) {
  const PartId w = wall(), p = peg(-5);
  std::uint64_t begins = 0, events = 0;
  for (int i = 0; i < 600; ++i) {
    const StepReport report = tick({session.push(ada, p, Vec3(3, 0, 0))});
    for (const ClashEvent& event : report.events) begins += event.kind == ClashEvent::Kind::kBegin;
    events += report.events.size();
    ASSERT_LE(session.pose(p).p.x(), -1.0 + kTouch_mm) << i;
  }
  EXPECT_EQ(begins, 1U);
  EXPECT_LE(events, 3U);
  // And it ends when the part is taken away.
  const StepReport report = tick({session.push(ada, p, Vec3(-1, 0, 0))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kEnd);
  EXPECT_NEAR(gap(w, p), 1.0, 1e-3);
}

TEST_F(StopPolicy, SlidingAlongAWallIsNotBlocked) {
  wall();
  const PartId p = peg(-5);
  tick({session.push(ada, p, Vec3(10, 0, 0))});  // into contact
  const double x = session.pose(p).p.x();
  for (int i = 0; i < 20; ++i) {
    const StepReport report = tick({session.push(ada, p, Vec3(0, 0.5, 0.25))});
    EXPECT_EQ(report.counters.stopped_parts, 0U) << i;
  }
  EXPECT_NEAR(session.pose(p).p.y(), 10.0, 1e-12);
  EXPECT_EQ(session.pose(p).p.x(), x);
}

TEST_F(StopPolicy, ExactlyTouchingAtTheStartMayLeaveAndSlideButNotEnter) {
  const PartId w = wall(), p = peg(-1);  // faces coincide
  tick({});
  tick({session.push(ada, p, Vec3(0, 1, 0))});
  EXPECT_EQ(session.pose(p).p, Vec3(-1, 1, 0));
  tick({session.push(ada, p, Vec3(1, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -1.0, 2e-4);
  EXPECT_LE(session.pose(p).p.x(), -1.0 + kTouch_mm);
  tick({session.push(ada, p, Vec3(-2, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -3.0, 2e-4);
  EXPECT_GT(gap(w, p), 1.9);
}

TEST_F(StopPolicy, ThinWallIsNotPassed) {
  session.add("wall", box_mesh(Vec3(0, -50, -50), Vec3(1e-3, 50, 50)), at(0, 0, 0), false);
  const PartId p = session.add("peg", cube_mesh(1), at(-5.2995, 0, 0), true);
  session.grab(ada, p);
  const StepReport report = tick({session.push(ada, p, Vec3(20, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -0.5, 2e-6);
  EXPECT_LE(session.pose(p).p.x(), -0.5);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  // From contact as well.
  for (int i = 0; i < 5; ++i) {
    tick({session.push(ada, p, Vec3(20, 0, 0))});
    ASSERT_LE(session.pose(p).p.x(), -0.5 + kTouch_mm);
  }
}

TEST_F(StopPolicy, InterferingPartMayBeWithdrawnButNotPressedDeeper) {
  wall();
  const PartId p = peg(-0.5);  // 0.5 mm deep
  StepReport report = tick({});
  ASSERT_EQ(report.events.size(), 1U);
  tick({session.push(ada, p, Vec3(0.4, 0, 0))});
  EXPECT_LE(session.pose(p).p.x(), -0.5 + 2e-3);
  for (int i = 0; i < 50; ++i) tick({session.push(ada, p, Vec3(0.0005, 0, 0))});  // no creeping
  EXPECT_LE(session.pose(p).p.x(), -0.5 + 2e-3);
  tick({session.push(ada, p, Vec3(0, 3, 0))});  // along it
  EXPECT_NEAR(session.pose(p).p.y(), 3.0, 1e-12);
  tick({session.push(ada, p, Vec3(-0.3, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -0.8, 2e-3);
  report = tick({session.push(ada, p, Vec3(-0.7, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -1.5, 2e-3);
  ASSERT_FALSE(report.events.empty());
  EXPECT_EQ(report.events.back().kind, ClashEvent::Kind::kEnd);
  tick({session.push(ada, p, Vec3(2, 0, 0))});  // and is held at the wall from then on
  EXPECT_LE(session.pose(p).p.x(), -1.0 + kTouch_mm);
}

// Drawn with an overlap: a peg in a block without its hole, a part wholly inside, a copy on one
// place. At their surfaces they become deeper on the way out, and yet they may leave.
TEST_F(StopPolicy, APartThatLiesDeepInAnotherComesOut) {
  const TriangleMesh block = cube_mesh(40);
  const TriangleMesh peg_mesh = box_mesh(Vec3(-5, -5, -30), Vec3(5, 5, 30));
  struct Pair {
    const TriangleMesh& mesh;
    double z;
  };
  const TriangleMesh core = cube_mesh(10);
  double x = 0.0;
  std::vector<PartId> parts;
  for (const Pair& pair : {Pair{peg_mesh, 15.0}, Pair{core, 0.0}, Pair{block, 0.0}}) {
    session.add("block", block, at(x, 0, 0), false);
    parts.push_back(session.add("part", pair.mesh, at(x, 0, pair.z), true));
    session.grab(ada, parts.back());
    x += 100.0;
  }
  for (int i = 0; i < 40; ++i) {
    std::vector<Increment> pushes;
    for (const PartId part : parts) pushes.push_back(session.push(ada, part, Vec3(0, 0, 2)));
    tick(pushes);
  }
  for (const PartId part : parts) EXPECT_GT(session.pose(part).p.z(), 60.0);
  EXPECT_TRUE(snapshot_of(session.world).open_clashes.empty());
}

// A bar that ends with the block and in its middle: its end is deepest below the surface when it
// passes the middle, while both together get less deep all the way.
TEST_F(StopPolicy, ABarThatEndsInTheMiddleComesOut) {
  session.add("block", cube_mesh(37.9), at(0, 0, 0), false);
  const float half = 3.24F, end = 18.95F;  // as a file holds them
  const PartId bar = session.add("bar", box_mesh(Vec3(-half, -half, -half), Vec3(half, half, end)),
                                 at(0, 0, 0), true);
  session.grab(ada, bar);
  for (int i = 0; i < 80; ++i) tick({session.push(ada, bar, Vec3(0, 0, 57.0 / 180))});
  EXPECT_GT(session.pose(bar).p.z(), 25.0);
}

TEST_F(StopPolicy, TwoMoversCannotSwapPlaces) {
  const PartId p = peg(-5);
  const PartId q = session.add("pin", cube_mesh(2), at(5, 0, 0), true);
  session.grab(bob, q);
  const StepReport report =
      tick({session.push(ada, p, Vec3(10, 0, 0)), session.push(bob, q, Vec3(-10, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -1.0, 2e-6);
  EXPECT_NEAR(session.pose(q).p.x(), 1.0, 2e-6);
  EXPECT_EQ(report.counters.stopped_parts, 2U);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
}

TEST_F(StopPolicy, MoverRunsIntoOneThatWasStoppedBeforeIt) {
  // p runs into the wall at t = 0.4; q follows 1 mm behind and must stop at p's back.
  wall();
  const PartId p = peg(-5);
  const PartId q = session.add("pin", cube_mesh(2), at(-8, 0, 0), true);
  session.grab(bob, q);
  const StepReport report =
      tick({session.push(ada, p, Vec3(10, 0, 0)), session.push(bob, q, Vec3(10, 0, 0))});
  EXPECT_NEAR(session.pose(p).p.x(), -1.0, 2e-6);
  EXPECT_NEAR(session.pose(q).p.x(), -3.0, 4e-6);
  EXPECT_LE(session.pose(q).p.x(), session.pose(p).p.x() - 2.0);
  EXPECT_EQ(report.counters.rounds, 2U);
  EXPECT_EQ(report.counters.stopped_parts, 2U);
  EXPECT_EQ(report.events.size(), 2U);
}

TEST_F(StopPolicy, PartsCarriedTogetherAreNotHeldAndCostLittle) {
  const PartId p = peg(-5);
  const PartId q = session.add("pin", cube_mesh(2), at(-2.9, 0, 0), true);  // 0.1 mm apart
  session.grab(bob, q);
  tick({});
  std::uint64_t asked = 0;
  for (int i = 0; i < 100; ++i) {
    const StepReport report =
        tick({session.push(ada, p, Vec3(1, 2, 3)), session.push(bob, q, Vec3(1, 2, 3))});
    EXPECT_EQ(report.counters.stopped_parts, 0U);
    asked += report.counters.first_contact_queries;
  }
  EXPECT_LE(asked, 3U);
  EXPECT_NEAR(session.pose(p).p.z(), 300.0, 1e-9);
}

TEST_F(StopPolicy, OrderOfPartsAndIncrementsDoesNotMatter) {
  // Five pegs pushed at one another; the same with the parts declared in reverse.
  const auto play = [&](bool reversed) {
    SessionBuilder s(Policy::kStop);
    std::vector<PartId> id(5);
    for (int k = 0; k < 5; ++k) {
      const int i = reversed ? 4 - k : k;
      id[static_cast<std::size_t>(i)] = s.add(std::string("p").append(std::to_string(i)),
                                              cube_mesh(2), at(4.0 * i, 0.3 * i, 0), true);
    }
    const UserId user = s.join("ada");
    for (const PartId part : id) s.grab(user, part);
    Scratch own;
    for (int t = 0; t < 5; ++t) {
      std::vector<Increment> increments;
      for (int k = 0; k < 5; ++k) {
        const int i = reversed ? 4 - k : k;
        increments.push_back(s.push(user, id[static_cast<std::size_t>(i)],
                                    Vec3(i < 2 ? 1.5 + 0.1 * i : -1.0 - 0.2 * i, 0.05 * t, 0),
                                    Vec3(0, 0, 0.02 * i)));
      }
      play_tick(s.world, increments, own);
    }
    std::vector<Vec3> places;
    for (const PartId part : id) places.push_back(s.pose(part).p);
    return places;
  };
  const auto forward = play(false), backward = play(true);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LT((forward[i] - backward[i]).norm(), 1e-4) << i;
}

TEST_F(StopPolicy, TurningIntoAWallStopsTheTurn) {
  // A bar 4 x 0.2 x 0.2 turning about z meets a 0.2 cube at (0, 1.5, 0) at t = 0.9092085160.
  const PartId cube = session.add("cube", cube_mesh(0.2), at(0, 1.5, 0), false);
  const PartId bar =
      session.add("bar", box_mesh(Vec3(-2, -0.1, -0.1), Vec3(2, 0.1, 0.1)), at(0, 0, 0), true);
  session.grab(ada, bar);
  const StepReport report = tick({session.push(ada, bar, Vec3::Zero(), Vec3(0, 0, 0.5 * M_PI))});
  EXPECT_EQ(report.counters.stopped_parts, 1U);
  EXPECT_NEAR(2.0 * std::acos(session.pose(bar).q.w()), 0.9092085160 * 0.5 * M_PI, 1e-5);
  EXPECT_LT(gap(cube, bar), 2e-6);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_NEAR(report.events[0].t_contact, 0.9092085160, 1e-5);
}

TEST_F(StopPolicy, WithABandTheMoverStopsWhereInterferenceBecomesCertain) {
  const PartId w = wall(), p = peg(-5);
  session.set_tolerance(w, 0.05);
  session.set_tolerance(p, 0.05);
  const StepReport report = tick({session.push(ada, p, Vec3(10, 0, 0))});
  // Real from an overlap of 0.1 on.
  EXPECT_NEAR(session.pose(p).p.x(), -0.9, 2e-4);
  EXPECT_LE(session.pose(p).p.x(), -0.9 + 1e-9);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  // Below that it moves freely.
  tick({session.push(ada, p, Vec3(-0.05, 0, 0))});
  const double x = session.pose(p).p.x();
  const StepReport slide = tick({session.push(ada, p, Vec3(0.02, 1, 0))});
  EXPECT_EQ(slide.counters.stopped_parts, 0U);
  EXPECT_NEAR(session.pose(p).p.x(), x + 0.02, 1e-12);
}

}  // namespace
}  // namespace mortise
