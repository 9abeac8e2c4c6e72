#include "common/geometry/triangle_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/math/rotation.h"

namespace mortise {
namespace {

Triangle random_triangle(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Triangle t;
  for (Vec3& p : t) p = Vec3(normal(random), normal(random), normal(random));
  return t;
}

Triangle moved(const Triangle& t, double scale, const Quat& q, const Vec3& p) {
  return {q * (scale * t[0]) + p, q * (scale * t[1]) + p, q * (scale * t[2]) + p};
}

// The stupid twin: alternate projections from many starts onto the two convex sets.
Vec3 project(const Vec3& x, const Triangle& t) {
  Vec3 best = t[0];
  double best2 = (x - t[0]).squaredNorm();
  const auto take = [&](const Vec3& y) {
    if ((x - y).squaredNorm() < best2) {
      best2 = (x - y).squaredNorm();
      best = y;
    }
  };
  for (int k = 0; k < 3; ++k) {
    const Vec3 e = t[(k + 1) % 3] - t[k];
    const double s =
        e.squaredNorm() > 0 ? std::clamp(e.dot(x - t[k]) / e.squaredNorm(), 0.0, 1.0) : 0;
    take(t[k] + s * e);
  }
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  if (n.squaredNorm() > 0) {
    const Vec3 foot = x - n * (n.dot(x - t[0]) / n.squaredNorm());
    bool in = true;
    for (int k = 0; k < 3; ++k) in = in && (t[(k + 1) % 3] - t[k]).cross(foot - t[k]).dot(n) >= 0.0;
    if (in) take(foot);
  }
  return best;
}

double distance_by_projections(const Triangle& a, const Triangle& b) {
  double best = 1e300;
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j) {
      Vec3 x = (i * a[0] + j * a[1] + (3 - i - j) * a[2]) / 3.0, y = project(x, b);
      for (int k = 0; k < 3000; ++k) {
        const Vec3 next = project(y, a);
        if (next == x) break;
        x = next;
        y = project(x, b);
      }
      best = std::min(best, (x - y).norm());
    }
  return best;
}

bool on_triangle(const Vec3& x, const Triangle& t, double slack) {
  return (project(x, t) - x).norm() <= slack;
}

TEST(TriangleDistance, AgreesWithProjections) {
  std::mt19937_64 random(31);
  int apart = 0, crossing = 0;
  for (int i = 0; i < 400; ++i) {
    const Triangle a = random_triangle(random), b = random_triangle(random);
    const TriangleDistance d = triangle_distance(a, b);
    const double twin = distance_by_projections(a, b);
    EXPECT_LE(d.distance_mm, twin + 1e-13);
    EXPECT_GE(d.distance_mm, twin - 2e-3) << "the projections converge slowly, but converge";
    if (d.crossing) {
      ++crossing;
      EXPECT_EQ(d.distance_mm, 0.0);
      EXPECT_LT(triangle_separation(a, b).distance_mm, 0.0);
      continue;
    }
    ++apart;
    EXPECT_NEAR((d.point_a - d.point_b).norm(), d.distance_mm, 1e-14);
    EXPECT_TRUE(on_triangle(d.point_a, a, 1e-13));
    EXPECT_TRUE(on_triangle(d.point_b, b, 1e-13));
    const double separation = triangle_separation(a, b).distance_mm;
    EXPECT_GT(separation, 0.0);
    EXPECT_LE(separation, d.distance_mm + 1e-13);
  }
  EXPECT_GT(apart, 100);
  EXPECT_GT(crossing, 50);
}

TEST(TriangleDistance, KnowsNoScale) {
  std::mt19937_64 random(32);
  for (int i = 0; i < 200; ++i) {
    const Triangle a = random_triangle(random), b = random_triangle(random);
    const TriangleDistance one = triangle_distance(a, b);
    const Quat q = rotation_exp(Vec3(0.1 * i, 1, 2));
    for (double scale : {1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12}) {
      const TriangleDistance other =
          triangle_distance(moved(a, scale, q, Vec3::Zero()), moved(b, scale, q, Vec3::Zero()));
      EXPECT_EQ(one.crossing, other.crossing);
      EXPECT_NEAR(other.distance_mm / scale, one.distance_mm, 1e-13);
    }
  }
}

TEST(TriangleDistance, HandCases) {
  const Triangle a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const auto to = [&](const Vec3& x, const Vec3& y, const Vec3& z) {
    return triangle_distance(a, {x, y, z});
  };
  // corner over face, corner to corner, edge to edge, face over corner, coplanar beside
  EXPECT_DOUBLE_EQ(to({.2, .2, 1}, {.2, .2, 2}, {.3, .3, 2}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(to({2, 0, 0}, {3, 0, 0}, {3, 1, 0}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(to({.5, -2, 1}, {.5, 2, 1}, {.5, 0, 5}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(to({-9, -9, -1}, {9, -9, -1}, {0, 18, -1}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(to({0, -1, 0}, {1, -1, 0}, {0, -2, 0}).distance_mm, 1.0);
  // coplanar: one in the other, crossing edges, the same triangle, a shared edge
  EXPECT_EQ(to({.1, .1, 0}, {.3, .1, 0}, {.1, .3, 0}).distance_mm, 0.0);
  EXPECT_EQ(to({-1, .2, 0}, {2, .2, 0}, {.5, -3, 0}).distance_mm, 0.0);
  EXPECT_EQ(to(a[0], a[1], a[2]).distance_mm, 0.0);
  EXPECT_EQ(to({0, 0, 0}, {1, 0, 0}, {0, -1, 1}).distance_mm, 0.0);
  EXPECT_FALSE(to(a[0], a[1], a[2]).crossing);
  // a needle through the middle of a face, far from every edge
  const TriangleDistance needle = to({.2, .2, -5}, {.2, .2, 5}, {.2001, .2, 5});
  EXPECT_TRUE(needle.crossing);
  EXPECT_EQ(needle.distance_mm, 0.0);
}

TEST(TriangleDistance, SliversAndTrianglesWithoutArea) {
  const Triangle a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const Vec3 p(.25, .25, 1);
  // a point, a segment (two ways), three points on a line
  EXPECT_DOUBLE_EQ(triangle_distance(a, {p, p, p}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(triangle_distance(a, {p, p, p + Vec3(0, 0, 1)}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(triangle_distance(a, {p, p + Vec3(0, 0, 1), p + Vec3(0, 0, 2)}).distance_mm,
                   1.0);
  EXPECT_DOUBLE_EQ(triangle_distance({p, p, p}, {-p, -p, -p}).distance_mm, 2 * p.norm());
  for (double thin : {1e-3, 1e-6, 1e-9, 1e-12}) {
    // Caps and needles a hundred long; the point above their middle is one away.
    const Triangle cap = {Vec3(-50, 0, 0), Vec3(50, 0, 0), Vec3(0, thin, 0)};
    const Triangle needle = {Vec3(-50, 0, 0), Vec3(50, 0, 0), Vec3(50, thin, 0)};
    const Triangle above = {Vec3(1, thin / 4, 1), Vec3(1, thin / 4, 2), Vec3(1.1, thin / 4, 2)};
    EXPECT_NEAR(triangle_distance(cap, above).distance_mm, 1.0, 1e-12) << thin;
    EXPECT_NEAR(triangle_distance(needle, above).distance_mm, 1.0, 1e-12) << thin;
  }
}

TEST(TriangleDistance, AlmostParallelEdges) {
  for (double angle : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
    // Edges of length 200 that cross at `angle`, one above the other; the third corners point away.
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const Triangle a = {Vec3(-100, 0, 0), Vec3(100, 0, 0), Vec3(0, 0, -1)};
    const Triangle b = {-100 * along + Vec3(0, 0, 0.01), 100 * along + Vec3(0, 0, 0.01),
                        Vec3(0, 0, 1)};
    EXPECT_NEAR(triangle_distance(a, b).distance_mm, 0.01, 1e-13) << angle;
  }
}

TEST(TriangleSeparation, PassingStraightThroughIsDeepFromOutsideOnly) {
  // Two faces that look at each other: a looks along +x, b along -x.
  const Triangle a = {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  for (double x : {0.1, -0.1}) {
    const Triangle b = {Vec3(x, 0, 0), Vec3(x, 0, 1), Vec3(x, 1, 0)};
    EXPECT_NEAR(triangle_separation(a, b).distance_mm, 0.1, 1e-15);
    EXPECT_NEAR(triangle_separation_outside(a, b).distance_mm, x, 1e-15);
  }
}

}  // namespace
}  // namespace mortise
