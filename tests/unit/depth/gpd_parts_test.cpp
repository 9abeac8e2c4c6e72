// What the generalized depth is made of, each against a slow twin or its own certificate.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/depth/depth.h"
#include "common/depth/gpd/hull_depth.h"
#include "common/depth/gpd/minimax.h"
#include "common/depth/gpd/separation_search.h"
#include "common/math/rotation.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

using gpd::TwistFrame;
using gpd::Vec6;

struct TwistRandom {
  std::mt19937_64 engine{31};
  std::normal_distribution<double> normal;
  Vec3 vector() { return {normal(engine), normal(engine), normal(engine)}; }
  Vec6 twist(double shift, double turn) {
    Vec6 xi;
    xi << shift * vector(), turn * vector();
    return xi;
  }
};

TEST(GpdParts, TheLongestPathIsThatOfTheFarthestCorner) {
  TwistRandom random;
  for (const SolidPtr& part : {shapes::solid(shapes::sphere(10, {1, 2, 3}, 40)),
                               shapes::solid(shapes::ring({10, 0, 20, 64, 3, 0}, 20)),
                               shapes::solid(shapes::box({5, 1, 0.1}))})
    for (int i = 0; i < 200; ++i) {
      const Pose X = shapes::random_pose(random.engine, 30.0);
      const TwistFrame frame(*part, X);
      const Vec6 xi = random.twist(i % 3 == 0 ? 0.0 : 1.0, i % 5 == 0 ? 0.0 : 3.0);
      const double slow = longest_path_brute_force_mm(*part, X, frame, xi);
      const double fast = longest_path_mm(*part, X, frame, xi);
      EXPECT_GE(fast, slow * (1.0 - 1e-14));
      EXPECT_LE(fast, slow * (1.0 + 2e-9));
    }
}

// |v + w x (p - c)| is the speed of p all along exp(s ξ), so it is the length of its path.
TEST(GpdParts, SpeedIsTheSameAllAlongAScrew) {
  TwistRandom random;
  const SolidPtr part = shapes::solid(shapes::box({5, 3, 1}));
  for (int i = 0; i < 40; ++i) {
    const Pose X = shapes::random_pose(random.engine, 10.0);
    const TwistFrame frame(*part, X);
    const Vec6 xi = random.twist(4.0, 3.0);
    const Vec3 p = X * part->mesh().points_mm[static_cast<std::size_t>(i % 8)];
    double path = 0.0;
    constexpr int kSteps = 2000;
    for (int k = 0; k < kSteps; ++k)
      path += (frame.pose_of(xi * ((k + 1.0) / kSteps)) * p - frame.pose_of(xi * (k / 2000.0)) * p)
                  .norm();
    EXPECT_NEAR(path, frame.velocity_of(xi, p).norm(), 1e-5 * path);
  }
}

TEST(GpdParts, TwistsAndPosesGoBothWays) {
  TwistRandom random;
  const SolidPtr part = shapes::solid(shapes::box({5, 3, 1}));
  for (const double turn : {0.0, 1e-9, 1e-4, 0.999e-3, 1.001e-3, 0.1, 1.0, 3.0})
    for (int i = 0; i < 20; ++i) {
      const TwistFrame frame(*part, shapes::random_pose(random.engine, 30.0));
      Vec6 xi;
      xi << random.vector(), turn * frame.radius_mm * random.vector().normalized();
      EXPECT_LT((frame.twist_of(frame.pose_of(xi)) - xi).norm(), 1e-8);
    }
}

// The bound is made of multipliers alone: where it meets the length, both are right.
TEST(GpdParts, LeastDistancesAreCertified) {
  TwistRandom random;
  int solved = 0, contradictory = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<gpd::Row> rows(static_cast<std::size_t>(1 + i % 6));
    for (gpd::Row& row : rows) row = {random.twist(1.0, 1.0), random.normal(random.engine)};
    if (i % 10 == 0) rows.push_back({-rows[0].g, 1.0 - rows[0].h});
    const gpd::LeastDistance least = gpd::least_distance(rows);
    if (!least.solved) {
      ++contradictory;
      EXPECT_EQ(i % 10, 0) << i;
      continue;
    }
    ++solved;
    for (const gpd::Row& row : rows) EXPECT_GE(row.g.dot(least.z), row.h - 1e-9);
    EXPECT_LE(least.bound, least.z.norm() * (1.0 + 1e-12));
    EXPECT_GE(least.bound, least.z.norm() * (1.0 - 1e-9));
  }
  EXPECT_GT(solved, 300);
  EXPECT_GT(contradictory, 10);
}

// The bound of the program is never above what it finds, and close to it.
TEST(GpdParts, MinimaxProgramsAreBracketed) {
  TwistRandom random;
  const SolidPtr part = shapes::solid(shapes::peg({10, 0, 30, 24, 1, 0}));
  const Pose X;
  const TwistFrame frame(*part, X);
  gpd::Minimax program(frame, part->outline().corners);
  for (int i = 0; i < 60; ++i) {
    std::vector<gpd::Row> rows(static_cast<std::size_t>(1 + i % 8));
    for (gpd::Row& row : rows) {
      const Vec3 n = random.vector().normalized(), arm = 10.0 * random.vector();
      row.g << n, arm.cross(n) / frame.radius_mm;
      row.h = 0.1 + 0.1 * std::fabs(random.normal(random.engine));
    }
    Vec6 xi;
    if (!program.solve(rows, xi)) continue;
    const double longest = longest_path_mm(*part, X, frame, xi);
    const double bound = program.lower_bound_mm(rows, 0.96 * longest);
    EXPECT_LE(bound, longest * (1.0 + 1e-9)) << i;
    EXPECT_GE(bound, 0.95 * longest) << i;
  }
}

TEST(GpdParts, ConvexMeshesAreKnown) {
  const auto slack = [](const TriangleMesh& mesh) {
    return shapes::solid(mesh)->outline().convex_slack_mm;
  };
  EXPECT_LT(slack(shapes::box({5, 3, 1}, {100, 0, 0}, 4)), 1e-12);
  EXPECT_LT(slack(shapes::sphere(10, {1, 2, 3}, 20)), 1e-10);
  EXPECT_LT(slack(shapes::sphere(10, {1, 2, 3}, 60)), 1e-7);  // a large one
  EXPECT_LT(slack(shapes::peg({10, 0, 20, 32, 3, 0})), 1e-10);
  EXPECT_TRUE(std::isinf(slack(shapes::ring({10, 0, 20, 32, 1, 0}, 20))));
  EXPECT_TRUE(std::isinf(slack(shapes::u_slot(10, 4, 8, 5, 0, 30))));
  EXPECT_TRUE(std::isinf(
      slack(shapes::together(shapes::box({1, 1, 1}), shapes::box({1, 1, 1}, {5, 0, 0})))));
  TriangleMesh dented = shapes::box({5, 5, 5}, Vec3::Zero(), 2);
  for (Vec3& x : dented.points_mm)
    if ((x - Vec3(5, 0, 0)).norm() < 1e-9) x.x() -= 1e-4;
  EXPECT_GT(slack(dented), 1e-4);
  EXPECT_LT(slack(dented), 1e-3);
  TriangleMesh large = shapes::sphere(10, Vec3::Zero(), 60);
  large.points_mm[500] *= 0.9999;
  EXPECT_TRUE(std::isinf(slack(large)));
}

TEST(GpdParts, HullsOfLargeMeshesComeApartLikeSpheres) {
  const SolidPtr a = shapes::solid(shapes::sphere(10, Vec3::Zero(), 80)),
                 b = shapes::solid(shapes::sphere(6, Vec3::Zero(), 64));
  TwistRandom random;
  for (int i = 0; i < 10; ++i) {
    const Pose X{rotation_exp(random.vector()), 15.5 * random.vector().normalized()};
    const gpd::HullDepth depth = gpd::hull_depth(*a, X, *b, Pose(), 1e-8);
    EXPECT_LT(depth.depth_mm.width(), 1e-7);
    EXPECT_LT(depth.depth_mm.hi, 0.5);
    EXPECT_GT(depth.depth_mm.lo, 0.48);
    CcdScratch scratch;
    const auto moved = [&](double by) { return Pose{X.q, X.p + by * depth.normal_W}; };
    EXPECT_TRUE(gpd::is_apart(*a, moved(depth.depth_mm.hi + 1e-7), *b, Pose(), scratch));
    EXPECT_FALSE(gpd::is_apart(*a, moved(depth.depth_mm.lo - 1e-6), *b, Pose(), scratch));
  }
}

TEST(GpdParts, TheWayMeetsWhatStandsInIt) {
  const SolidPtr part = shapes::solid(shapes::box({1, 1, 1}));
  SeparatingMotion motion;
  motion.translation_mm = Vec3(4, 0, 0);
  CcdScratch scratch;
  const auto met = [&](const Vec3& at) {
    return met_on_way(*part, Pose(), motion, *part, Pose::translation(at), scratch);
  };
  ASSERT_TRUE(met({4, 0, 0}).has_value());
  EXPECT_NEAR(*met({4, 0, 0}), 0.5, 1e-6);
  EXPECT_FALSE(met({7, 0, 0}).has_value());
  EXPECT_FALSE(met({0, 2, 0}).has_value());     // touches, and slides along it
  EXPECT_FALSE(met({-2, 0, 0}).has_value());    // touches, and is left
  EXPECT_TRUE(met({2, 0, 0}).has_value());      // touches, and is pressed
  EXPECT_FALSE(met({-1.9, 0, 0}).has_value());  // overlaps, and is left
  EXPECT_TRUE(met({1.9, 0, 0}).has_value());    // overlaps, and goes deeper
}

TEST(GpdParts, TheWayOutOfAPairMayGoDeeperFirst) {
  const SolidPtr a = shapes::solid(shapes::box({1, 1, 1})),
                 b = shapes::solid(shapes::box({1, 5, 5}));
  const SurfaceBand band = nominal_band();
  OverlapQuery query;
  query.a = a.get();
  query.b = b.get();
  query.band_a = query.band_b = &band;
  query.X_WA = Pose::translation({1.9, 0, 0});
  CcdScratch scratch;
  SeparatingMotion out, through;
  out.translation_mm = Vec3(0.2, 0, 0);
  through.translation_mm = Vec3(-4, 0, 0);
  out.about_W = through.about_W = query.X_WA.p;
  EXPECT_FALSE(way_goes_deeper(query, 0.1 + 1e-4, out, scratch));
  EXPECT_TRUE(way_goes_deeper(query, 0.1 + 1e-4, through, scratch));
}

}  // namespace
}  // namespace mortise
