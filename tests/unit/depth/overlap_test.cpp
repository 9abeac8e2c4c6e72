#include "common/depth/depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;
using Case = OverlapCase;

void expect_depth(const OverlapResult& result, double depth_mm, double accuracy_mm = 1.1e-4) {
  ASSERT_FALSE(result.regions.empty());
  const Interval delta = result.regions.front().delta_mm;
  EXPECT_NEAR(delta.lo, depth_mm, 1e-9);
  EXPECT_GE(delta.hi, depth_mm - 1e-9);
  EXPECT_LE(delta.hi, depth_mm + accuracy_mm);
}

// The failure of vertex sampling was a depth that changed with the number of triangles.
TEST(Overlap, CubesAreAsDeepAtAnyTessellation) {
  for (const int n : {1, 2, 4, 8, 20})
    for (const int m : {1, 3}) {
      const Case c{solid(box({.5, .5, .5}, Vec3::Zero(), n)),
                   solid(box({.5, .5, .5}, {.9, .13, .07}, m))};
      const OverlapResult result = overlap_of(c);
      expect_depth(result, 0.1);
      ASSERT_EQ(result.regions.size(), 1U);
      EXPECT_NEAR(result.regions[0].normal_W.x(), -1.0, 1e-9);
      EXPECT_TRUE(result.regions[0].has_witness);
      EXPECT_TRUE(result.meshes_cross);
      EXPECT_FALSE(result.contained);
    }
}

TEST(Overlap, TenThousandTriangles) {
  const Case c{solid(box({.5, .5, .5}, Vec3::Zero(), 29)),
               solid(box({.5, .5, .5}, {.9, .13, .07}, 1))};
  ASSERT_GT(c.a->mesh().triangles.size(), 10000U);
  expect_depth(overlap_of(c), 0.1);
}

TEST(Overlap, FlushCubesAndDeepCubes) {
  expect_depth(overlap_of({solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {.9, 0, 0}))}), 0.1);
  // The deepest point lies inside a face: found to the accuracy asked for.
  const Interval half =
      overlap_of({solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {.5, .1, .2}))})
          .regions.at(0)
          .delta_mm;
  EXPECT_NEAR(half.lo, 0.5, 1.1e-4);
  EXPECT_GE(half.hi, 0.5);
  EXPECT_LE(half.hi, 0.5 + 1.1e-4);
}

// depth/README.md, section 9: crossing bars.
TEST(Overlap, CrossingBarsWithoutAnyVertexInside) {
  for (const int n : {1, 3, 6}) {
    const Case c{solid(box({5, .5, .5}, Vec3::Zero(), n)), solid(box({.5, 5, .5}, {0, 0, .8}, n))};
    const OverlapResult result = overlap_of(c);
    expect_depth(result, 0.2);
    EXPECT_NEAR(result.regions[0].normal_W.z(), -1.0, 1e-9);
  }
}

// depth/README.md, section 1: surface to surface, a documented underestimate for parts thinner than
// the overlap.
TEST(Overlap, BarThroughSlabIsALowerBound) {
  const OverlapResult result = overlap_of({solid(box({.2, .2, 3})), solid(box({5, 5, .2}))});
  ASSERT_FALSE(result.regions.empty());
  EXPECT_GE(result.regions[0].delta_mm.lo, 0.2 - 1e-9);
  EXPECT_LE(result.regions[0].delta_mm.lo, 0.4 + 1e-9);
}

TEST(Overlap, Spheres) {
  for (const int n : {16, 32}) {
    const Case c{solid(sphere(1, Vec3::Zero(), n)), solid(sphere(2, {2.5, 0, 0}, n))};
    const OverlapResult result = overlap_of(c);
    ASSERT_EQ(result.regions.size(), 1U);
    const double sagitta = 3.0 * (1.0 - std::cos(std::numbers::pi / n)) * 2.0;
    EXPECT_LE(result.regions[0].delta_mm.lo, 0.5);
    EXPECT_GE(result.regions[0].delta_mm.hi, 0.5 - sagitta);
  }
}

// depth/README.md, section 9: pegs and holes of 32 facets.
TEST(Overlap, PegAndHolePolygons) {
  for (const int rows : {1, 2}) {
    const SolidPtr hole = solid(ring({10, 0, 20, 32, rows, 0}, 20));
    const double half_phase = std::numbers::pi / 32;
    expect_depth(overlap_of({solid(peg({10, -5, 15, 32, rows, half_phase})), hole}), 0.048152733,
                 2e-4);
    expect_depth(overlap_of({solid(peg({10.01, -5, 15, 32, rows, 0})), hole}), 0.01);
    EXPECT_TRUE(overlap_of({solid(peg({10, -5, 15, 32, rows, 0})), hole}).regions.empty());
    EXPECT_TRUE(overlap_of({solid(peg({9.9, -5, 15, 32, rows, 0})), hole}).regions.empty());
  }
}

TEST(Overlap, KeyInSlot) {
  const SolidPtr slot = solid(u_slot(10, 4, 8, 5, 0, 30));
  // 0.03 too wide on the right, 0.02 above the floor.
  const OverlapResult result = overlap_of({solid(box({4, 3, 10}, {0.03, 3.02, 15})), slot});
  expect_depth(result, 0.03);
  EXPECT_NEAR(result.regions[0].normal_W.x(), -1.0, 1e-9);
}

TEST(Overlap, TouchIsNotOverlap) {
  for (const double gap : {0.0, 1e-12, 1e-7, -1e-7}) {
    const Case c{solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {1 + gap, .2, .1}, 4))};
    const OverlapResult result = overlap_of(c);
    EXPECT_TRUE(result.regions.empty()) << gap;
    EXPECT_FALSE(result.meshes_cross);
  }
}

TEST(Overlap, AThousandCoplanarTrianglesCostLittle) {
  Case c{solid(box({5, 5, 1}, {0, 0, 1}, 16)), solid(box({50, 50, 1}, {0, 0, -1}))};
  c.refinement = Refinement::kDecided;
  const OverlapResult result = overlap_of(c);
  EXPECT_TRUE(result.regions.empty());
  EXPECT_LT(result.evaluations, 3000U);
}

TEST(Overlap, ContainedAndCoincidentParts) {
  Case inside{solid(box({.5, .5, .5})), solid(box({3, 3, 3}, Vec3::Zero(), 4))};
  OverlapResult result = overlap_of(inside);
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_TRUE(result.contained);
  EXPECT_EQ(worst_class(result), CollisionClass::kReal);
  const Case same{solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, Vec3::Zero(), 3))};
  result = overlap_of(same);
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_EQ(worst_class(result), CollisionClass::kReal);
  EXPECT_GT(result.regions[0].delta_mm.lo, 0.1);
  // A ball in the cavity of a hollow box touches nothing.
  TriangleMesh cavity = box({2, 2, 2});
  for (auto& t : cavity.triangles) std::swap(t[1], t[2]);
  const Case hollow{solid(sphere(1.0)), solid(together(box({3, 3, 3}), cavity))};
  EXPECT_TRUE(overlap_of(hollow).regions.empty());
}

TEST(Overlap, TwoPlacesAreTwoRegions) {
  const SolidPtr bar = solid(box({10, 1, 1}));
  const SolidPtr walls =
      solid(together(box({1, 5, 5}, {-10.5, 0, 0}), box({1, 5, 5}, {10.7, 0, 0})));
  const OverlapResult result = overlap_of({bar, walls});
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_NEAR(result.regions[0].delta_mm.lo, 0.5, 1e-9);
  EXPECT_NEAR(result.regions[1].delta_mm.lo, 0.3, 1e-9);
}

TEST(Overlap, OpenMeshesCrossButHaveNoDepth) {
  TriangleMesh open = box({.5, .5, .5});
  open.triangles.pop_back();
  Case c{solid(open), solid(box({.5, .5, .5}, {.9, .1, .1}))};
  const OverlapResult result = overlap_of(c);
  EXPECT_TRUE(result.no_inside);
  EXPECT_TRUE(result.meshes_cross);
  EXPECT_EQ(worst_class(result), CollisionClass::kPotential);
  c.X_WA = Pose::translation({-3, 0, 0});
  EXPECT_TRUE(overlap_of(c).regions.empty());
}

// A block on its edge before a wall: its edge comes out farther than its faces, in a part without
// an inside as well.
TEST(Overlap, AnOpenPartReachesAsFarAsItsEdges) {
  TriangleMesh open = box({5, 5, 5});
  std::erase_if(open.triangles, [&](const auto& t) {  // without its bottom
    return open.points_mm[t[0]].z() + open.points_mm[t[1]].z() + open.points_mm[t[2]].z() < -14.0;
  });
  constexpr double kOffset_mm = 0.05, kTurn_rad = 0.25 * std::numbers::pi;
  const double reach_mm = kOffset_mm * (1.0 + std::numbers::sqrt2);
  Case c{solid(open), solid(box({5, 5, 5}))};
  const auto band = [&](const SolidPtr& part) {
    BandInput input;
    input.solid = part.get();
    input.rest = {{-kOffset_mm, kOffset_mm}, "±0.05 mm"};
    return build_band(input);
  };
  c.band_a = band(c.a);
  c.band_b = band(c.b);
  c.refinement = Refinement::kDecided;
  c.X_WA.q = Quat(Eigen::AngleAxisd(kTurn_rad, Vec3::UnitZ()));
  const auto at = [&](double gap_mm) {
    c.X_WB = Pose::translation({5.0 + 5.0 * std::numbers::sqrt2 + gap_mm, 0.3, 0.2});
    const CollisionClass word = worst_class(overlap_of(c));
    EXPECT_EQ(word, worst_class(
                        overlap_of({c.b, c.a, c.band_b, c.band_a, c.X_WB, c.X_WA, c.refinement})));
    return word;
  };
  EXPECT_FALSE(c.a->has_inside());
  for (const double gap_mm : {0.09, 0.105, 0.115, reach_mm - 2e-4})
    EXPECT_EQ(at(gap_mm), CollisionClass::kPotential) << gap_mm;
  EXPECT_EQ(at(5.0 * reach_mm), CollisionClass::kNone);
}

// The same answers anywhere, at any scale.
TEST(Overlap, InvariantUnderMotionAndScale) {
  std::mt19937_64 random(7);
  for (const double scale : {1e-2, 1.0, 1e2})
    for (const double reach : {1.0, 1e5}) {
      const Pose X = random_pose(random, reach * scale);
      Case c{solid(scaled(box({.5, .5, .5}, Vec3::Zero(), 2), scale)),
             solid(scaled(box({.5, .5, .5}, {.9, .13, .07}, 3), scale)),
             nominal_band(),
             nominal_band(),
             X,
             X};
      OverlapResult result = overlap_of(c);
      ASSERT_EQ(result.regions.size(), 1U);
      EXPECT_NEAR(result.regions[0].delta_mm.lo, 0.1 * scale, 1e-9 * scale * reach);
      EXPECT_NEAR((X.q.conjugate() * result.regions[0].normal_W).x(), -1.0, 1e-6);
      c.a = solid(scaled(peg({10, -5, 15, 32, 1, std::numbers::pi / 32}), scale));
      c.b = solid(scaled(ring({10, 0, 20, 32, 1, 0}, 20), scale));
      result = overlap_of(c);
      ASSERT_FALSE(result.regions.empty());
      EXPECT_NEAR(result.regions[0].delta_mm.lo, 0.0481527332 * scale, 1e-8 * scale * reach);
    }
}

TEST(Overlap, DeterministicAndSymmetric) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 20; ++i) {
    Case c{solid(box({1, .7, .4}, Vec3::Zero(), 2)),
           solid(box({.8, .9, .6}, Vec3::Zero(), 1)),
           nominal_band(),
           nominal_band(),
           random_pose(random, 0.6),
           random_pose(random, 0.6)};
    const OverlapResult once = overlap_of(c), twice = overlap_of(c);
    std::swap(c.a, c.b);
    std::swap(c.X_WA, c.X_WB);
    const OverlapResult swapped = overlap_of(c);
    ASSERT_EQ(once.regions.size(), twice.regions.size());
    EXPECT_EQ(once.evaluations, twice.evaluations);
    if (once.regions.empty()) continue;
    EXPECT_EQ(once.regions[0].delta_mm, twice.regions[0].delta_mm);
    ASSERT_FALSE(swapped.regions.empty());
    ASSERT_EQ(once.regions.size(), swapped.regions.size());
    EXPECT_EQ(once.regions[0].delta_mm, swapped.regions[0].delta_mm);
    EXPECT_EQ(once.regions[0].normal_W, -swapped.regions[0].normal_W);
    EXPECT_EQ(once.regions[0].triangle_a, swapped.regions[0].triangle_b);
    ASSERT_TRUE(once.regions[0].certain_place.known());
    EXPECT_EQ(once.regions[0].certain_place.role, 1 - swapped.regions[0].certain_place.role);
  }
}

}  // namespace
}  // namespace mortise
