// The direction along which two cells are farthest apart, or least deep in each other, beside a
// search over the whole sphere.
#include "common/depth/cells/least_reach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/depth/cells/convex_cell.h"
#include "common/math/pose.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}
Vec3 any_direction(Random& random) {
  for (;;) {
    const Vec3 v(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

// A cylinder with a chamfer, or a prism over a polygon.
ConvexCell any_cell(Random& random) {
  const double r = uniform(random, 2.0, 15.0), h = uniform(random, 2.0, 30.0);
  if (random() % 2 == 0) {
    const double bevel = uniform(random, 0.1, 0.4) * std::min(r, h), k = std::sqrt(0.5);
    const MeridianLine lines[] = {{1.0, 0.0, 0.5 * h},
                                  {-1.0, 0.0, 0.5 * h},
                                  {0.0, 1.0, r},
                                  {k, k, k * (0.5 * h + r - bevel)}};
    return *round_cell(Vec3::Zero(), Vec3::UnitZ(), lines);
  }
  std::vector<Vec2> polygon;
  const int n = 3 + static_cast<int>(random() % 9);
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * (i + uniform(random, -0.2, 0.2)) / n;
    polygon.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return *prism_cell({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, polygon, {-0.5 * h, 0.5 * h});
}

struct Pair {
  ConvexCell k, s;
  Pose X_KS;
  PointOfEach farthest(const Vec3& n) const {
    return {k.farthest(n), X_KS * s.farthest(-(X_KS.q.conjugate() * n))};
  }
  double reach_mm(const Vec3& n) const { return farthest(n).across().dot(n); }
};

// Over the sphere, and closer about the best direction.
double least_of_all_mm(const Pair& pair) {
  constexpr int kDirections = 4000;
  double least = 1e9;
  Vec3 best = Vec3::UnitX();
  const auto look = [&](const Vec3& n) {
    const double reach = pair.reach_mm(n);
    if (reach >= least) return false;
    least = reach;
    best = n;
    return true;
  };
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kDirections, r = std::sqrt(1.0 - z * z);
    look({r * std::cos(2.4 * i), r * std::sin(2.4 * i), z});
  }
  for (double step = 0.05; step > 1e-10;) {
    const Vec3 from = best, u = from.unitOrthogonal(), v = from.cross(u);
    bool better = false;
    for (int i = 0; i < 16; ++i) {
      const double a = std::numbers::pi / 8.0 * i;
      better |= look((from + step * (std::cos(a) * u + std::sin(a) * v)).normalized());
    }
    if (!better) step *= 0.5;
  }
  return least;
}

struct Found {
  double reach_mm = 1e9;
  PointOfEach touching;
};

Found by_nearest_points(const Pair& pair) {
  Found found;
  const auto farthest = [&](const Vec3& n) { return pair.farthest(n); };
  const auto tried = [&](const Vec3&, double reach_mm) {
    EXPECT_LE(reach_mm, found.reach_mm);
    found.reach_mm = reach_mm;
    return false;
  };
  const Vec3 between = pair.X_KS * pair.s.middle - pair.k.middle;
  LeastReach search(farthest, tried, between.norm());
  search.run(between.normalized(), 1e9, 1e-3);
  found.touching = search.touching();
  return found;
}

// Cells that are apart are found apart. How far, and how little they overlap, is that of the whole
// sphere but for few.
TEST(LeastReach, IsThatOfTheWholeSphere) {
  Random random(9001);
  int apart = 0, nearer = 0, shallow = 0, deeper = 0;
  for (int i = 0; i < test::effort(600); ++i) {
    Pair pair{any_cell(random), any_cell(random), {}};
    pair.X_KS.q = rotation_exp(uniform(random, 0.0, 3.0) * any_direction(random));
    const Vec3 way = any_direction(random);
    pair.X_KS.p = 60.0 * way;
    for (int k = 0; k < 30; ++k) pair.X_KS.p += by_nearest_points(pair).reach_mm * way;
    pair.X_KS.p += uniform(random, -0.01, 0.02) * way;
    const double least = least_of_all_mm(pair), at_touch = by_nearest_points(pair).reach_mm;
    if (least < -1e-6) {
      ++apart;
      EXPECT_LT(at_touch, 0.0) << i;
      nearer += at_touch > least + 1e-3 * std::fabs(least) + 2e-7;
    } else {
      ++shallow;
      deeper += at_touch > 1.05 * least + 2e-7;
    }
  }
  std::printf("%d apart, %d of them told nearer; %d overlap, %d told deeper\n", apart, nearer,
              shallow, deeper);
  EXPECT_GT(apart, test::effort(150));
  EXPECT_GT(shallow, test::effort(60));
  EXPECT_LE(nearer, apart / 10);
  EXPECT_LE(deeper, shallow / 20);
}

// Both points are of their cells, and as far apart as the direction says.
TEST(LeastReach, NamesWhereBothTouch) {
  Random random(9002);
  for (int i = 0; i < test::effort(300); ++i) {
    Pair pair{any_cell(random), any_cell(random), {}};
    pair.X_KS.q = rotation_exp(uniform(random, 0.0, 3.0) * any_direction(random));
    pair.X_KS.p = 60.0 * any_direction(random);
    const Found found = by_nearest_points(pair);
    EXPECT_LT(found.reach_mm, 0.0);
    EXPECT_NEAR(found.touching.across().norm(), -found.reach_mm, 1e-5) << i;
    for (int k = 0; k < 50; ++k) {
      const Vec3 n = any_direction(random);
      EXPECT_LE(n.dot(found.touching.k), pair.k.support_mm(n) + 1e-9);
      EXPECT_LE(n.dot(pair.X_KS.inverse() * found.touching.s), pair.s.support_mm(n) + 1e-9);
    }
  }
}

// Bit for bit, and of those that are as far the first.
TEST(HullCorners, TheFarthestIsThatOfALoop) {
  Random random(11);
  int ties = 0;
  EXPECT_EQ(HullCorners().farthest(Vec3::UnitX()).reach_mm, -kInfinity);
  for (int i = 0; i < 20'000; ++i) {
    HullCorners corners;
    const bool coarse = i % 2 == 0;
    for (std::size_t count = 1 + random() % 60; count > 0; --count) {
      const Vec3 x = 20.0 * any_direction(random);
      corners.push_back(coarse ? Vec3(x.array().round()) : x);
    }
    const Vec3 n = coarse ? Vec3::Unit(i / 2 % 3) : any_direction(random);
    std::size_t index = 0;
    for (std::size_t k = 0; k < corners.size(); ++k)
      if (n.dot(corners[k]) > n.dot(corners[index])) index = k;
    for (std::size_t k = index + 1; k < corners.size(); ++k)
      ties += n.dot(corners[k]) == n.dot(corners[index]) ? 1 : 0;
    const HullCorners::Farthest farthest = corners.farthest(n);
    ASSERT_EQ(farthest.index, index);
    ASSERT_EQ(farthest.reach_mm, n.dot(corners[index]));
  }
  EXPECT_GT(ties, 1'000);
}

}  // namespace
}  // namespace mortise
