// What is already the case at t = 0, and pairs that touch and go.
#include <gtest/gtest.h>

#include <cmath>

#include "common/ccd/start_state.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

const SolidPtr& cube() {
  static const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  return cube;
}

FirstContact from_touch(const SolidPtr& a, const Motion& motion, const SolidPtr& b, const Pose& X) {
  ContactQuery q = query(a, motion, b, still_motion(X));
  q.ignore_touching_at_start = true;
  return solve(q);
}

TEST(StartState, TouchingSurfacesAreNotAnOverlap) {
  for (double gap : {0.0, 1e-15, -1e-15, 2e-7}) {
    const FirstContact c =
        solve(cube(), slide({0, 0, 0}, {-1, 0, 0}), cube(), still_motion(shift(1 + gap, 0.3, 0.2)));
    EXPECT_EQ(c.state, ContactState::kTouchingAtStart) << gap;
    EXPECT_EQ(c.t_clear, 0.0);
    EXPECT_EQ(c.t_contact, 0.0);
    EXPECT_LE(c.distance_mm, 1e-6);
    EXPECT_NEAR(c.point_a_W.x(), 0.5, 1e-6);
  }
  EXPECT_EQ(solve(cube(), slide({0, 0, 0}, {-1, 0, 0}), cube(), still_motion(shift(1 + 2e-6, 0, 0)))
                .state,
            ContactState::kFree);
}

TEST(StartState, OverlapIsSeenWhateverItsForm) {
  const auto state = [](const SolidPtr& a, const Pose& Xa, const SolidPtr& b, const Pose& Xb) {
    return solve(a, move(Xa, shift(50, 0, 0) * Xa), b, still_motion(Xb)).state;
  };
  // A corner in a face, and only edges through faces (no corner inside).
  EXPECT_EQ(state(cube(), turn({0.3, 0.4, 0.1}), cube(), shift(1.05, 0, 0)),
            ContactState::kOverlappingAtStart);
  const SolidPtr along_x = solid(box_mesh({10, 1, 1})), along_y = solid(box_mesh({1, 10, 1}));
  EXPECT_EQ(state(along_x, {}, along_y, shift(0, 0, 0.8)), ContactState::kOverlappingAtStart);
  // In line, all side faces in common planes: nothing crosses, and yet 0.1 deep in each other.
  const FirstContact in_line =
      solve(cube(), slide({0, 0, 0}, {-5, 0, 0}), cube(), still_motion(shift(0.9, 0, 0)));
  EXPECT_EQ(in_line.state, ContactState::kOverlappingAtStart);
  // One and the same place.
  const FirstContact same = solve(cube(), slide({0, 0, 0}, {5, 0, 0}), cube());
  EXPECT_EQ(same.state, ContactState::kOverlappingAtStart);
  EXPECT_TRUE(same.contained);
}

TEST(StartState, InsideIsSeenWithoutAnySurfaceMeeting) {
  const SolidPtr block = solid(box_mesh({10, 10, 10}));
  const Motion stays_within = slide({0, 0, 0}, {2, 0, 0});
  const FirstContact in = solve(cube(), stays_within, block);
  EXPECT_EQ(in.state, ContactState::kOverlappingAtStart);
  EXPECT_TRUE(in.contained);
  EXPECT_TRUE(solve(block, slide({0, 0, 0}, {2, 0, 0}), cube()).contained) << "the other way round";
  ContactQuery unasked = query(cube(), stays_within, block, Motion{});
  unasked.check_contained = false;
  EXPECT_EQ(solve(unasked).state, ContactState::kFree) << "the surfaces do not meet";
  EXPECT_FALSE(contained(*cube(), {}, *block, shift(20, 0, 0), 1e-6));
  // A cavity is not inside the material; its wall is met like any other.
  TriangleMesh hollow = box_mesh({10, 10, 10});
  append(hollow, inside_out(box_mesh({6, 6, 6})));
  const FirstContact c = solve(cube(), slide({0, 0, 0}, {4, 0, 0}), solid(hollow));
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.t_contact, 2.5 / 4, 1e-6);
  // Of two shells, the second is inside.
  TriangleMesh two = box_mesh({1, 1, 1}, {20, 0, 0});
  append(two, box_mesh({1, 1, 1}));
  EXPECT_TRUE(solve(solid(two), stays_within, block).contained);
  // An open mesh has no inside.
  TriangleMesh open = box_mesh({10, 10, 10});
  open.triangles.pop_back();
  EXPECT_EQ(solve(cube(), stays_within, solid(open)).state, ContactState::kFree);
}

// Touching begins at a quarter of the accuracy, whatever boxes could say at the start.
TEST(StartState, WithinAQuarterOfTheAccuracyIsTouching) {
  for (double accuracy : {0.1, 1e-2, 1e-4, 1e-6, 1e-8})
    for (const double way : {0.5, -0.1})
      for (const double gap : {0.2, 0.3}) {
        ContactQuery q =
            query(cube(), slide({1.0 + gap * accuracy, 0, 0}, {1.0 + way, 0, 0}), cube(), Motion{});
        q.accuracy_mm = accuracy;
        const FirstContact c = solve(q);
        if (gap < 0.25)
          EXPECT_EQ(c.state, ContactState::kTouchingAtStart) << accuracy << ' ' << way;
        else
          EXPECT_EQ(c.state, way > 0.0 ? ContactState::kFree : ContactState::kContact) << accuracy;
      }
}

TEST(StartState, TouchingPartsMayLeaveSlideAndTurn) {
  const SolidPtr plate = solid(box_mesh({20, 20, 1}, {0, 0, -0.5}));
  for (double gap : {0.0, 1e-7, -1e-7, 1e-15}) {
    const Pose on = shift(0, 0, 0.5 + gap);
    const auto go = [&](const Pose& to) {
      return from_touch(cube(), move(on, to * on), plate, {});
    };
    for (const Pose& to : {shift(0, 0, 1), shift(3, 0, 0), shift(3, -2, 0.5), turn({0, 0, 1})}) {
      const FirstContact c = go(to);
      EXPECT_EQ(c.state, ContactState::kFree) << gap;
      EXPECT_TRUE(c.touched_at_start);
    }
    // Pressed in: stopped at once, at most the accuracy deep.
    for (const Pose& to : {shift(0, 0, -1), shift(5, 0, -0.1), turn({0.3, 0, 0})}) {
      const FirstContact c = go(to);
      ASSERT_EQ(c.state, ContactState::kContact) << gap;
      EXPECT_TRUE(c.touched_at_start);
      EXPECT_LT(c.t_contact, 5e-5);
      const Pose X = move(on, to * on).pose_at(c.t_contact);
      EXPECT_GE((X * Vec3(0, 0, -0.5)).z(), -1.1e-6);
    }
  }
}

TEST(StartState, SlidingMeetsTheNextPart) {
  TriangleMesh mesh = box_mesh({20, 20, 1}, {0, 0, -0.5});
  append(mesh, box_mesh({1, 1, 1}, {5, 0, 0.5}));
  const SolidPtr plate_with_stop = solid(mesh);
  const FirstContact c = from_touch(cube(), slide({0, 0, 0.5}, {10, 0, 0.5}), plate_with_stop, {});
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.t_contact, 0.4, 2e-7);
}

TEST(StartState, PushingForHoursDoesNotCreepIn) {
  const SolidPtr plate = solid(box_mesh({20, 20, 1}, {0, 0, -0.5}));
  Pose at = shift(0, 0, 0.7);
  double deepest = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    Pose target = at;
    target.p += Vec3(tick % 2 == 0 ? 0.001 : -0.001, 0, -0.01);
    const Motion motion = move(at, target);
    const FirstContact c = from_touch(cube(), motion, plate, {});
    ASSERT_NE(c.state, ContactState::kOverlappingAtStart) << tick;
    at = motion.pose_at(c.t_contact);
    deepest = std::min(deepest, at.p.z() - 0.5);
  }
  EXPECT_GE(deepest, -1.1e-6);
}

TEST(StartState, WorkCapTellsWhatIsProven) {
  const SolidPtr peg = solid(prism_mesh(9.95, 64, -12.5, 12.5));
  const SolidPtr bore = solid(tube_mesh(10, 20, 64, -40, 40));
  ContactQuery q = query(peg, move({}, turn({0.02, 0, 0})), bore, Motion{});
  const FirstContact truth = solve(q);
  ASSERT_EQ(truth.state, ContactState::kContact);
  double last = 0.0;
  int undecided = 0;
  for (std::uint64_t cap = 1; cap < 100000; cap *= 3) {
    q.work_cap = cap;
    const FirstContact c = solve(q);
    if (c.state == ContactState::kUndecided) {
      ++undecided;
      EXPECT_LE(c.t_clear, truth.t_contact);
      EXPECT_GE(c.t_clear, last) << "more work never proves less";
      last = c.t_clear;
    } else {
      EXPECT_EQ(c.t_contact, truth.t_contact);
    }
  }
  EXPECT_GT(undecided, 3);
}

}  // namespace
}  // namespace mortise::testing
