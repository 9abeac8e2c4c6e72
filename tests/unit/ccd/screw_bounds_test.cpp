// What a screw keeps apart: against the triangles themselves, and whole queries against the same
// tick in parts too short for it.
#include "common/ccd/screw_bounds.h"

#include <gtest/gtest.h>

#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

// Triangles about the z axis, most of them small, some nearly as large as their distance from it.
TriangleMesh ring_of_triangles(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * unit(random), r = 3.0 + 7.0 * unit(random);
    const double size = i % 5 == 0 ? r : 1.0;
    const Vec3 middle(r * std::cos(angle), r * std::sin(angle), 6.0 * unit(random) - 3.0);
    for (int k = 0; k < 3; ++k)
      mesh.points_mm.push_back(
          middle + size * (Vec3(unit(random), unit(random), unit(random)) - Vec3::Constant(0.5)));
    const auto n = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.triangles.push_back({n - 3, n - 2, n - 1});
  }
  return mesh;
}

double distance_of_leaves(const Bvh& a, std::int32_t leaf_a, const Pose& X_WA, const Bvh& b,
                          std::int32_t leaf_b, const Pose& X_WB) {
  const auto triangle = [](const Bvh& bvh, std::uint32_t i, const Pose& X) {
    const auto& c = bvh.corners[i];
    return Triangle{X * Vec3(c[0], c[1], c[2]), X * Vec3(c[3], c[4], c[5]),
                    X * Vec3(c[6], c[7], c[8])};
  };
  const Bvh::Leaf &of_a = a.leaves[~leaf_a], &of_b = b.leaves[~leaf_b];
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < of_a.count; ++i)
    for (std::uint32_t j = 0; j < of_b.count; ++j)
      least = std::min(least, triangle_distance(triangle(a, of_a.first + i, X_WA),
                                                triangle(b, of_b.first + j, X_WB))
                                  .distance_mm);
  return least;
}

struct Tick {
  SolidPtr a, b;
  Motion motion_a, motion_b;
};

// One part turns about an axis near its own, with any lead; the other stands still or slides.
Tick random_tick(std::mt19937_64& random, int i) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Tick tick{solid(ring_of_triangles(random, 40)), solid(ring_of_triangles(random, 40)), {}, {}};
  const Pose at = random_pose(random, 100.0, kPi);
  const double angle = kPi * unit(random), along = i % 4 == 0 ? 0.0 : 8.0 * unit(random);
  const Vec3 drift =
      i % 3 == 0 ? Vec3(0.02 * unit(random), 0.02 * unit(random), 0.0) : Vec3(0, 0, 0);
  const Pose turned = turn({0, 0, angle}, Vec3(0, 0, along) + drift);
  const Vec3 reference = i % 2 == 0 ? Vec3(0, 0, 0) : Vec3(0, 0, 5.0 * unit(random));
  const Motion turns = linear_motion(at, at * turned, reference);
  const Motion slides = i % 5 == 0
                            ? linear_motion(at, at * shift(0, 0, 3.0 * unit(random)), Vec3::Zero())
                            : still_motion(at);
  tick.motion_a = i % 7 < 4 ? turns : slides;
  tick.motion_b = i % 7 < 4 ? slides : turns;
  return tick;
}

// Every pair of nodes whose time is asked for stands for its leaves.
TEST(ScrewBounds, GrantNoTimeThatIsNotFree) {
  constexpr double kTaken_mm = 1e-3;
  std::mt19937_64 random(81);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int whole = 0, later = 0, near = 0;
  CcdScratch scratch;
  for (int i = 0; i < 120; ++i) {
    const Tick tick = random_tick(random, i);
    const Bvh &a = tick.a->bvh(), &b = tick.b->bvh();
    ccd::PairMotion motion(*tick.a, tick.motion_a, *tick.b, tick.motion_b);
    ccd::ScrewBounds bounds(motion, a, b, kTaken_mm, scratch);
    const double t0 = i % 2 == 0 ? 0.0 : 0.7 * unit(random);
    for (std::int32_t x = 0; x < static_cast<std::int32_t>(a.leaves.size()); ++x)
      for (std::int32_t y = 0; y < static_cast<std::int32_t>(b.leaves.size()); ++y) {
        const double until = bounds.free_until(~x, ~y, t0);
        ASSERT_GE(until, t0);
        whole += until >= 1.0, later += until > t0 && until < 1.0;
        const double last = std::min(until, 1.0);
        double least = std::numeric_limits<double>::infinity();
        for (int s = 0; s <= 24 && until > t0; ++s) {
          const double t = t0 + (last - t0) * (s / 24.0 - 1e-9);
          least = std::min(least, distance_of_leaves(a, ~x, tick.motion_a.pose_at(t), b, ~y,
                                                     tick.motion_b.pose_at(t)));
        }
        ASSERT_GT(least, kTaken_mm) << "tick " << i << ", leaves " << x << " and " << y;
        near += until >= 1.0 && least < 0.3;
      }
  }
  EXPECT_GT(whole, 1000);
  EXPECT_GT(later, 1000);
  EXPECT_GT(near, 100) << "not so timid as to be useless";
}

TriangleMesh one_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleMesh mesh;
  mesh.points_mm = {a, b, c};
  mesh.triangles.push_back({0, 1, 2});
  return mesh;
}

// A speck is laid so that it meets a point of a large triangle at a known time.
TEST(ScrewBounds, WhatMeetsIsNotKeptApart) {
  constexpr double kSpeck_mm = 1e-7;
  std::mt19937_64 random(84);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  CcdScratch scratch;
  int with_angle = 0;
  for (int i = 0; i < 4000; ++i) {
    const Pose at = random_pose(random, 50.0, kPi);
    const double angle = (i % 2 == 0 ? 1.0 : -1.0) * (0.1 + 3.0 * unit(random));
    const Vec3 drift = i % 3 == 0 ? Vec3(0.1 * unit(random), 0.1 * unit(random), 0) : Vec3(0, 0, 0);
    const Motion turns =
        linear_motion(at, at * turn({0, 0, angle}, Vec3(0, 0, 20.0 * (unit(random) - 0.5)) + drift),
                      Vec3::Zero());
    Vec3 x[3];
    for (Vec3& corner : x)
      corner = Vec3(12.0 * unit(random) - 3.0, 12.0 * unit(random) - 6.0, 6.0 * unit(random));
    const double p = unit(random), q = (1.0 - p) * unit(random), t = unit(random);
    const Vec3 place = p * x[0] + q * x[1] + (1.0 - p - q) * x[2];
    // The large triangle stands, the speck turns, or the other way round.
    const bool speck_turns = i % 4 < 2;
    const Pose X_W_speck = speck_turns ? turns.pose_at(t) : at;
    const Pose X_W_large = speck_turns ? at : turns.pose_at(t);
    const Vec3 met = X_W_speck.inverse() * (X_W_large * place);
    const SolidPtr large = solid(one_triangle(x[0], x[1], x[2]));
    const SolidPtr speck =
        solid(one_triangle(met, met + Vec3(kSpeck_mm, 0, 0), met + Vec3(0, kSpeck_mm, kSpeck_mm)));
    const Motion stands = still_motion(at);
    ccd::PairMotion motion(*speck, speck_turns ? turns : stands, *large,
                           speck_turns ? stands : turns);
    ccd::ScrewBounds bounds(motion, speck->bvh(), large->bvh(), 0.0, scratch);
    const double until = bounds.free_until(speck->bvh().root, large->bvh().root, 0.0);
    ASSERT_LE(until, t) << i;
    with_angle += until > 0.5 * t;
  }
  EXPECT_GT(with_angle, 300) << "not so timid as to be useless";
}

TEST(ScrewBounds, ANodeGrantsNoMoreThanItsLeaves) {
  std::mt19937_64 random(82);
  CcdScratch scratch;
  int granted = 0;
  for (int i = 0; i < 30; ++i) {
    const Tick tick = random_tick(random, i);
    const Bvh &a = tick.a->bvh(), &b = tick.b->bvh();
    ccd::PairMotion motion(*tick.a, tick.motion_a, *tick.b, tick.motion_b);
    ccd::ScrewBounds bounds(motion, a, b, 0.0, scratch);
    for (std::size_t x = 0; x < a.nodes.size(); ++x)
      for (std::size_t y = 0; y < b.leaves.size(); ++y) {
        const double until =
            bounds.free_until(static_cast<std::int32_t>(x), ~static_cast<std::int32_t>(y), 0.0);
        granted += until > 0.0;
        for (int k = 0; k < a.nodes[x].count; ++k)
          ASSERT_GE(bounds.free_until(a.nodes[x].child[k], ~static_cast<std::int32_t>(y), 0.0),
                    until);
      }
  }
  EXPECT_GT(granted, 100);
}

// A thread of a V section, closed at its ends: flanks at 45 degrees, `turns` turns of 2 mm.
TriangleMesh thread(double root_r, double tip_r, double turns, int facets) {
  constexpr double kPitch_mm = 2.0;
  TriangleMesh mesh;
  const int steps = static_cast<int>(turns * facets);
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2.0 * kPi * i / facets, z = kPitch_mm * i / facets;
    const double half = 0.5 * std::abs(tip_r - root_r);
    for (const Vec3& rz : {Vec3(root_r, 0, z - half), Vec3(tip_r, 0, z), Vec3(root_r, 0, z + half)})
      mesh.points_mm.emplace_back(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.z());
  }
  const bool outer = tip_r > root_r;
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    mesh.triangles.push_back(outer ? std::array{p, q, r} : std::array{p, r, q});
  };
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = 3 * i + k, q = 3 * i + (k + 1) % 3;
      add(p, p + 3, q + 3), add(p, q + 3, q);
    }
  add(0, 1, 2);
  add(3 * steps, 3 * steps + 2, 3 * steps + 1);
  return mesh;
}

// The slow twin: the same tick in parts that turn too little for the bounds to be asked.
FirstContact in_parts(const ContactQuery& whole, int parts) {
  FirstContact found;
  for (int i = 0; i < parts; ++i) {
    ContactQuery part = whole;
    const auto cut = [&](const Motion& motion) {
      return motion.moves() ? linear_motion(motion.pose_at(static_cast<double>(i) / parts),
                                            motion.pose_at(static_cast<double>(i + 1) / parts),
                                            motion.reference_P)
                            : motion;
    };
    part.motion_a = cut(whole.motion_a), part.motion_b = cut(whole.motion_b);
    found = solve(part);
    found.t_contact = (i + found.t_contact) / parts;
    if (found.state != ContactState::kFree) return found;
  }
  return found;
}

TEST(ScrewBounds, ATickAnswersLikeItsParts) {
  const SolidPtr bolt = solid(thread(7.0, 7.8, 6, 48)), nut = solid(thread(9.0, 7.3, 3, 48));
  std::mt19937_64 random(83);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int contacts = 0, free = 0;
  for (int i = 0; i < 24; ++i) {
    const double start = kPi * unit(random),
                 angle = (i % 2 == 0 ? 1.0 : -1.0) * (2.0 + unit(random));
    const double error_mm = i % 3 == 0 ? 0.9 * unit(random) : 0.0;
    const Pose X0 = turn({0, 0, start}, {0, 0, 3.0 + start / kPi});
    const Pose X1 = turn({0, 0, start + angle}, {0, 0, 3.0 + (start + angle) / kPi + error_mm});
    const Motion turns = linear_motion(X0, X1, Vec3::Zero());
    ContactQuery asked = i % 2 == 0 ? query(nut, turns, bolt, still_motion({}))
                                    : query(bolt, still_motion({}), nut, turns);
    const FirstContact found = solve(asked), twin = in_parts(asked, 16);
    ASSERT_EQ(found.state, twin.state) << i;
    contacts += found.state == ContactState::kContact, free += found.state == ContactState::kFree;
    EXPECT_NEAR(found.t_contact, twin.t_contact, 1e-5) << i;
    asked.portable = true;
    const FirstContact portable = solve(asked);
    EXPECT_EQ(portable.t_contact, found.t_contact);
    EXPECT_EQ(portable.work.leaf_tests, found.work.leaf_tests);
  }
  EXPECT_GT(contacts, 2);
  EXPECT_GT(free, 8);
}

}  // namespace
}  // namespace mortise::testing
