// Our contact times and distances against FCL's collision test and distance at single poses. FCL's
// own continuous collision detection of meshes is not asked: it misses contacts (ccd/README.md,
// section 8).
#include <gtest/gtest.h>

#include <cstdio>

#include "common/ccd/distance.h"
#include "tests/oracle/fcl_model.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

struct Pair {
  SolidPtr a, b;
  FclModel fcl_a, fcl_b;
  Motion ma, mb;
};

SolidPtr random_shape(std::mt19937_64& random, int i) {
  switch (i % 3) {
    case 0:
      return solid(box_mesh({1.5, 0.3, 0.4}));
    case 1:
      return solid(convex_mesh(random, 14));
    default: {
      TriangleMesh cross = box_mesh({2, 0.3, 0.3});
      append(cross, box_mesh({0.3, 0.3, 2}, {0, 0.29, 0.1}));
      return solid(cross);
    }
  }
}

Pair random_pair(std::mt19937_64& random, int i) {
  Pair s;
  s.a = random_shape(random, i);
  s.b = random_shape(random, i / 3);
  s.fcl_a = fcl_model(s.a->mesh());
  s.fcl_b = fcl_model(s.b->mesh());
  const Pose a0 = random_pose(random, 2.0, kPi), b0 = random_pose(random, 2.0, kPi);
  const auto target = [&](const Pose& X) {
    return Pose{(random_pose(random, 0.0, i % 7 == 0 ? kPi : 2.5).q * X.q).normalized(),
                random_pose(random, 2.0, 0.0).p};
  };
  const Pose a1 = target(a0), b1 = target(b0);
  const Vec3 reference(0.1, 0.1, -0.1);
  s.ma = i % 2 == 0 ? linear_motion(a0, a1, reference) : screw_motion(a0, a1, reference);
  s.mb = i % 3 == 0 ? still_motion(b0) : linear_motion(b0, b1, reference);
  return s;
}

struct Tally {
  int missed = 0, late = 0, invented = 0, contacts = 0, movers = 0, free = 0, start = 0;
};

Tally compare(int cases, int looks, double late_by) {
  std::mt19937_64 random(61);
  CcdScratch scratch;
  Tally tally;
  for (int i = 0; i < cases; ++i) {
    const Pair s = random_pair(random, i);
    const auto collide = [&](double t) {
      return fcl_collide(s.fcl_a, s.ma.pose_at(t), s.fcl_b, s.mb.pose_at(t));
    };
    ContactQuery q = query(s.a, s.ma, s.b, s.mb);
    q.check_contained = false;
    const FirstContact c = first_contact(q, scratch);
    if (c.state == ContactState::kOverlappingAtStart || c.state == ContactState::kTouchingAtStart) {
      ++tally.start;
      tally.invented += !collide(0.0);
      continue;
    }
    const bool contact = c.state == ContactState::kContact;
    contact ? ++tally.contacts : ++tally.free;
    tally.movers += contact && s.mb.moves();
    const double until = contact ? c.t_contact + late_by : 1.0;
    bool met = false;
    for (int k = 0; k <= looks && !met; ++k) met = collide(until * k / looks);
    (contact ? tally.late : tally.missed) += met;
    if (contact) {
      const double d = fcl_distance(s.fcl_a, s.ma.pose_at(until), s.fcl_b, s.mb.pose_at(until));
      tally.invented += !(d <= q.accuracy_mm + 1e-9);
    }
  }
  return tally;
}

TEST(FclOracle, NothingMissedLateOrInvented) {
  const Tally t = compare(test::effort(1500), 100, 0.0);
  std::printf("%d contacts (%d of two movers), %d free, %d from the start\n", t.contacts, t.movers,
              t.free, t.start);
  EXPECT_EQ(t.missed, 0);
  EXPECT_EQ(t.late, 0);
  EXPECT_EQ(t.invented, 0);
  EXPECT_GT(t.contacts, 100);
  EXPECT_GT(t.movers, 50);
  EXPECT_GT(t.free, 50);
}

TEST(FclOracle, SeesContactsThatAreTenThousandthLate) {
  const Tally t = compare(80, 20, 1e-4);
  EXPECT_GE(t.late, t.contacts * 8 / 10);
  EXPECT_GT(t.contacts, 15);
}

TEST(FclOracle, Distances) {
  std::mt19937_64 random(62);
  CcdScratch scratch;
  int apart = 0;
  for (int i = 0; i < test::effort(300); ++i) {
    const Pair s = random_pair(random, i);
    const Pose Xa = s.ma.pose_at(0.0), Xb = s.mb.pose_at(0.0);
    const double ours = distance(*s.a, Xa, *s.b, Xb, scratch).distance_mm;
    const double theirs = fcl_distance(s.fcl_a, Xa, s.fcl_b, Xb);
    if (ours == 0.0) {
      EXPECT_TRUE(fcl_collide(s.fcl_a, Xa, s.fcl_b, Xb));
      continue;
    }
    ++apart;
    EXPECT_NEAR(ours, theirs, 1e-9);
  }
  EXPECT_GT(apart, 150);
}

}  // namespace
}  // namespace mortise::testing
