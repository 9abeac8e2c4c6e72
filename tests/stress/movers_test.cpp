// Two movers: swapping places, moving together, hardly or not at all.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

Pose any_pose(std::mt19937_64& random, double reach_mm) {
  return {rotation_exp(random_turn(random, kPi)), random_vector(random, reach_mm)};
}

// Each goes where the other was: the ends are free, the ways are not.
TEST(Movers, SwapPlaces) {
  Sweep sweep("two movers swap places");
  for (int i = 0; i < test::effort(120); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(500'000 + i));
    Case c;
    c.a = random_shape(random, i % kShapes);
    c.b = random_shape(random, i / kShapes % kShapes);
    const Vec3 side = uniform(random, 1.5, 4.0) * random_turn(random, 1.0).normalized();
    const Pose here{rotation_exp(random_turn(random, kPi)), side};
    const Pose there{i % 3 == 0 ? here.q : rotation_exp(random_turn(random, kPi)), -side};
    const auto go = [&](const Pose& from, const Pose& to) {
      return i % 2 == 0 ? linear_motion(from, to, Vec3::Zero())
                        : screw_motion(from, to, random_vector(random, 0.5));
    };
    c.motion_a = go(here, there);
    c.motion_b = go(there, here);
    c.check_contained = true;
    const ContactState state = sweep.ask(c, "swap " + std::to_string(i)).state;
    if (i % 2 == 0 && i % kShapes == 1 && i / kShapes % kShapes == 1) {
      EXPECT_EQ(state, ContactState::kContact) << "centres of convex shapes meet";
    }
  }
}

// One rigid group on one path: whatever the gap, it stays.
TEST(Movers, MoveTogether) {
  Sweep sweep("two movers in one group");
  int i = 0;
  for (const double gap_mm : {1.0, 1e-2, 1e-4, 1e-5})
    for (int round = 0; round < test::effort(8); ++round, ++i) {
      std::mt19937_64 random(static_cast<std::uint64_t>(510'000 + i));
      Case c;
      c.a = random_shape(random, 1);
      c.b = random_shape(random, 1);
      const Pose at{rotation_exp(random_turn(random, kPi)), random_vector(random, 3.0)};
      // B is slid towards A until the gap is left.
      const Vec3 n = random_turn(random, 1.0).normalized();
      Pose by{rotation_exp(random_turn(random, kPi)), at.p + 6 * n};
      Case near;
      near.a = c.a;
      near.b = c.b;
      near.motion_a = still_motion(at);
      near.motion_b = linear_motion(by, {by.q, at.p}, Vec3::Zero());
      near.separation_mm = gap_mm;
      near.accuracy_mm = 1e-9;
      const FirstContact stop = sweep.ask(near, "group stop " + std::to_string(i));
      ASSERT_EQ(stop.state, ContactState::kContact);
      by = near.motion_b.pose_at(stop.t_contact);
      const Pose G = any_pose(random, 5.0);
      if (i % 2 == 0) {
        c.motion_a = screw_motion(at, G * at, Vec3::Zero());
        c.motion_b = screw_motion(by, G * by, Vec3::Zero());
      } else {
        // The same point of the world is the reference of both.
        const Vec3 pivot = random_vector(random, 2.0);
        c.motion_a = linear_motion(at, G * at, at.inverse() * pivot);
        c.motion_b = linear_motion(by, G * by, by.inverse() * pivot);
      }
      c.ask_fcl = false;  // no distance shrinks: advancement would run out of steps
      const FirstContact answer = sweep.ask(c, "group " + std::to_string(i), 24);
      // Seen from the world the gap may cost more steps than the work cap grants: never a contact.
      EXPECT_TRUE(answer.state == ContactState::kFree ||
                  (gap_mm < 1e-4 && answer.state == ContactState::kUndecided))
          << gap_mm << ", " << i;
    }
}

TEST(Movers, HardlyOrNotAtAll) {
  Sweep sweep("zero and tiny motion");
  for (int i = 0; i < test::effort(60); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(520'000 + i));
    Case c;
    c.a = random_shape(random, i % kShapes);
    c.b = random_shape(random, i / 3 % kShapes);
    const Pose at = any_pose(random, 1.5), by = any_pose(random, 1.0);
    c.check_contained = true;
    for (const double way_mm : {0.0, 4.9e-324, 1e-300, 1e-160, 1e-30, 1e-17, 1e-9}) {
      const Vec3 v = way_mm * Vec3(1, -1, 1);
      const auto go = [&](const Pose& X) {
        Motion m = linear_motion(X, {X.q, X.p + v}, Vec3::Zero());
        if (way_mm > 0.0 && i % 2 == 0) {
          // Turns and ways below rounding of the pose: the ends are equal, the path is not still.
          m.kind = i % 4 == 0 ? PathKind::kLinear : PathKind::kScrew;
          m.v_W = v;
          m.w_W = v;
          if (m.kind == PathKind::kScrew) m.axis_W = X.p + Vec3(1, 0, 0);
        }
        return m;
      };
      c.motion_a = go(at);
      c.motion_b = i % 3 == 0 ? go(by) : still_motion(by);
      char label[64];
      std::snprintf(label, sizeof label, "way %g mm, case %d", way_mm, i);
      sweep.ask(c, label, 4);
    }
  }
  EXPECT_GT(sweep.free(), 50);
  EXPECT_GT(sweep.at_start(), 50);
  EXPECT_EQ(sweep.contacts(), 0);
}

}  // namespace
}  // namespace mortise::stress
