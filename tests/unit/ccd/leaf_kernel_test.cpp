#include <gtest/gtest.h>

#include <cstring>

#include "common/ccd/leaf_pair.h"
#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

constexpr double kTarget_mm = 1e-7, kSuspect_mm = 1e-6;

// A leaf of up to four triangles, and the same as a mesh.
struct Leaf {
  std::vector<Triangle> triangles;
  SolidPtr solid;
  ccd::LeafCorners corners() const {
    ccd::LeafCorners c;
    c.count = static_cast<int>(triangles.size());
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x)
          c.at[k][x][i] = triangles[i < c.count ? i : 0][k][x] - solid->bvh().origin[x];
    return c;
  }
};

Leaf random_leaf(std::mt19937_64& random, int count, double size_mm) {
  std::uniform_real_distribution<double> spread(-size_mm, size_mm);
  Leaf leaf;
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    Triangle t;
    for (Vec3& corner : t) {
      corner = Vec3(spread(random), spread(random), spread(random));
      mesh.points_mm.push_back(corner);
    }
    const auto n = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.triangles.push_back({n - 3, n - 2, n - 1});
    leaf.triangles.push_back(t);
  }
  leaf.solid = solid(std::move(mesh));
  return leaf;
}

struct Case {
  Leaf a, b;
  Motion motion_a, motion_b;
};

// Leaves near each other that turn and slide in every way that a tick may; some with a short way,
// some with almost half a turn.
Case random_case(std::mt19937_64& random, int i) {
  std::uniform_int_distribution<int> count(1, 4);
  Case c{random_leaf(random, count(random), 1.0), random_leaf(random, count(random), 1.5), {}, {}};
  const double turn = i % 4 == 0 ? kPi : i % 4 == 1 ? 0.3 : 0.05;
  const Pose a0 = random_pose(random, 3.0, kPi), b0 = random_pose(random, 1.0, kPi);
  const auto moved = [&](const Pose& from) {
    const Pose by = random_pose(random, i % 3 == 0 ? 4.0 : 0.2, turn);
    return Pose{(by.q * from.q).normalized(), from.p + by.p};
  };
  const auto some_motion = [&](const Pose& from) {
    const Vec3 reference = random_pose(random, 6.0, kPi).p;
    if (i % 5 == 0) return linear_motion(from, Pose{from.q, from.p + Vec3(1, 2, -1)}, reference);
    return i % 2 == 0 ? screw_motion(from, moved(from), reference)
                      : linear_motion(from, moved(from), reference);
  };
  c.motion_a = some_motion(a0);
  c.motion_b = i % 3 == 1   ? some_motion(b0)
               : i % 7 == 0 ? linear_motion(b0, Pose{b0.q, b0.p + Vec3(3, -2, 1)}, Vec3::Zero())
                            : still_motion(b0);
  return c;
}

double distance_at(const Case& c, double t, unsigned without) {
  const Pose X_WA = c.motion_a.pose_at(t), X_WB = c.motion_b.pose_at(t);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.a.triangles.size(); ++i)
    for (std::size_t j = 0; j < c.b.triangles.size(); ++j) {
      if ((without >> (4 * i + j) & 1U) != 0) continue;
      Triangle x = c.a.triangles[i], y = c.b.triangles[j];
      for (Vec3& corner : x) corner = X_WA * corner;
      for (Vec3& corner : y) corner = X_WB * corner;
      least = std::min(least, triangle_distance(x, y).distance_mm);
    }
  return least;
}

TEST(LeafKernel, GrantsNoTimeThatIsNotFree) {
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int granted = 0, long_granted = 0, suspects = 0, tight = 0;
  for (int i = 0; i < 4000; ++i) {
    const Case c = random_case(random, i);
    ccd::PairMotion motion(*c.a.solid, c.motion_a, *c.b.solid, c.motion_b);
    const double t0 = 0.7 * unit(random);
    motion.at(t0);
    const ccd::LeafAnswer answer = ccd::portable_kernels().leaf(
        motion.leaf_frame(kTarget_mm, kSuspect_mm), c.a.corners(), c.b.corners(), 1.0);
    suspects += answer.suspects != 0;
    if (!(answer.dt > 0.0)) continue;
    ++granted;
    long_granted += answer.dt > 0.3;
    const double until = std::min(answer.dt, 1.0 - t0);
    for (int s = 0; s <= 40; ++s)
      ASSERT_GT(distance_at(c, t0 + until * s / 40.0, answer.suspects), 0.0)
          << "case " << i << " at " << s << " of 40 of " << until;
    // Not so timid as to be useless: often most of what is left of the gap is used.
    tight += answer.suspects == 0 && answer.dt < 1.0 - t0 &&
             distance_at(c, t0 + until, 0) < 0.3 * distance_at(c, t0, 0);
  }
  EXPECT_GT(granted, 2000);
  EXPECT_GT(long_granted, 500);
  EXPECT_GT(suspects, 100);
  EXPECT_GT(tight, 60);
}

TEST(LeafKernel, WideAndPortableAgreeToTheLastBit) {
  if (ccd::wide_kernels() == nullptr)
    GTEST_SKIP() << "machine: no AVX2, the portable kernel is the only one";
  std::mt19937_64 random(72);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const Case c = random_case(random, i);
    ccd::PairMotion motion(*c.a.solid, c.motion_a, *c.b.solid, c.motion_b);
    motion.at(unit(random));
    const ccd::LeafFrame& frame = motion.leaf_frame(kTarget_mm, kSuspect_mm);
    const double enough = unit(random);
    const ccd::LeafAnswer x =
        ccd::portable_kernels().leaf(frame, c.a.corners(), c.b.corners(), enough);
    const ccd::LeafAnswer y =
        ccd::wide_kernels()->leaf(frame, c.a.corners(), c.b.corners(), enough);
    ASSERT_EQ(std::memcmp(&x.dt, &y.dt, sizeof x.dt), 0) << i;
    ASSERT_EQ(x.suspects, y.suspects) << i;
  }
}

TEST(LeafKernel, NamesWhatCrossesOrTouchesAsSuspect) {
  std::mt19937_64 random(73);
  int crossing = 0;
  for (int i = 0; i < 1000; ++i) {
    const Case c = random_case(random, i);
    ccd::PairMotion motion(*c.a.solid, c.motion_a, *c.b.solid, c.motion_b);
    motion.at(0.0);
    const ccd::LeafAnswer answer = ccd::best_kernels().leaf(
        motion.leaf_frame(kSuspect_mm, kSuspect_mm), c.a.corners(), c.b.corners(), 1.0);
    if (distance_at(c, 0.0, 0) > 0.0) continue;
    ++crossing;
    ASSERT_NE(answer.suspects, 0U) << i;
    ASSERT_GT(distance_at(c, 0.0, answer.suspects), 0.0) << "a crossing pair was not named, " << i;
  }
  EXPECT_GT(crossing, 30);
}

// A shaft that turns in its bore bends away from it: one step frees the whole tick.
TEST(LeafKernel, WhatTurnsAwayIsFreeUntilTheHorizon) {
  Leaf a, b;
  const auto leaf = [](std::initializer_list<Vec3> points) {
    Leaf l;
    TriangleMesh mesh;
    mesh.points_mm = points;
    mesh.triangles.push_back({0, 1, 2});
    l.triangles.push_back({mesh.points_mm[0], mesh.points_mm[1], mesh.points_mm[2]});
    l.solid = solid(mesh);
    return l;
  };
  a = leaf({{9.99, -0.1, 0}, {9.99, 0.1, 0}, {9.99, 0, 1}});
  b = leaf({{10, 3, -3}, {10, -3, -3}, {10, 0, 5}});
  const Pose turned = turn({0, 0, 0.4});
  const auto ask = [&](const Leaf& moving, const Leaf& still) {
    ccd::PairMotion motion(*moving.solid, move({}, turned), *still.solid, still_motion({}));
    motion.at(0.0);
    return ccd::best_kernels()
        .leaf(motion.leaf_frame(0.0, 0.0), moving.corners(), still.corners(), 1.0)
        .dt;
  };
  EXPECT_GE(ask(a, b), 1.0) << "the shaft turns in the bore";
  EXPECT_GE(ask(b, a), 1.0) << "the bore turns round the shaft: seen from the bore it bends away";
}

}  // namespace
}  // namespace mortise::testing
