#include "common/depth/overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/evaluation/verdict.h"
#include "common/geometry/signed_distance.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct Case {
  SolidPtr a, b;
  SurfaceBand band_a = nominal_band(), band_b = nominal_band();
  Pose X_WA = Pose(), X_WB = Pose();
  Refinement refinement = Refinement::kFull;
};

constexpr double kAll = -std::numeric_limits<double>::infinity();

OverlapResult overlap_of(const Case& c, bool only_certain = false, double ignore_below_mm = kAll) {
  OverlapQuery query;
  query.only_certain = only_certain;
  query.ignore_below_mm = ignore_below_mm;
  query.a = c.a.get();
  query.b = c.b.get();
  query.band_a = &c.band_a;
  query.band_b = &c.band_b;
  query.X_WA = c.X_WA;
  query.X_WB = c.X_WB;
  query.refinement = c.refinement;
  CcdScratch scratch;
  return find_overlap(query, scratch);
}

CollisionClass class_of(const OverlapRegion& region, bool no_inside = false) {
  return classify(
      {region.delta_mm, region.certain_mm, region.possible_mm, region.has_witness, no_inside});
}

CollisionClass worst_class(const OverlapResult& result) {
  CollisionClass worst = CollisionClass::kNone;
  for (const OverlapRegion& region : result.regions)
    worst = std::max(worst, class_of(region, result.no_inside));
  return worst;
}

void expect_depth(const OverlapResult& result, double depth_mm, double accuracy_mm = 1.1e-4) {
  ASSERT_FALSE(result.regions.empty());
  const Interval delta = result.regions.front().delta_mm;
  EXPECT_NEAR(delta.lo, depth_mm, 1e-9);
  EXPECT_GE(delta.hi, depth_mm - 1e-9);
  EXPECT_LE(delta.hi, depth_mm + accuracy_mm);
}

// ALG 6.2.1: the failure of vertex sampling was a depth that changed with the number of triangles.
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

// ALG 6.2.4.
TEST(Overlap, CrossingBarsWithoutAnyVertexInside) {
  for (const int n : {1, 3, 6}) {
    const Case c{solid(box({5, .5, .5}, Vec3::Zero(), n)), solid(box({.5, 5, .5}, {0, 0, .8}, n))};
    const OverlapResult result = overlap_of(c);
    expect_depth(result, 0.2);
    EXPECT_NEAR(result.regions[0].normal_W.z(), -1.0, 1e-9);
  }
}

// ALG 6.2.6b: boundary to boundary, a documented underestimate for parts thinner than the overlap.
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

// ALG 6.2.5 and collision.md section 7.
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

// collision.md section 7: a 20 mm fit at 32 facets.
struct FitCase {
  const char* code;
  CollisionClass expected;
};

class Fits : public ::testing::TestWithParam<FitCase> {};

TEST_P(Fits, ExactFeaturesTellTheFit) {
  const FitOffsets offsets = fit_offsets(GetParam().code, 10.0);
  for (const int shaft_n : {32, 48})
    for (const double phase : {0.0, 0.5, 0.21}) {
      Case c;
      c.a = solid(peg({10, -5, 15, shaft_n, 1, phase * 2 * std::numbers::pi / 32}));
      c.b = solid(ring({10, 0, 20, 32, 1, 0}, 20));
      c.band_a = cylinder_band(c.a, 10, false, offsets.shaft_mm);
      c.band_b = cylinder_band(c.b, 10, true, offsets.hole_mm);
      c.refinement = Refinement::kDecided;
      const OverlapResult result = overlap_of(c);
      const CollisionClass worst = worst_class(result);
      const bool apart = result.regions.empty() && GetParam().expected == CollisionClass::kFake;
      EXPECT_TRUE(worst == GetParam().expected || apart)
          << GetParam().code << " n " << shaft_n << " phase " << phase << " class "
          << static_cast<int>(worst);
      if (phase == 0.5 && shaft_n == 32) {
        EXPECT_FALSE(result.regions.empty());
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Overlap, Fits,
                         ::testing::Values(FitCase{"H7/g6", CollisionClass::kFake},
                                           FitCase{"H7/h6", CollisionClass::kFake},
                                           FitCase{"H8/f7", CollisionClass::kFake},
                                           FitCase{"H7/k6", CollisionClass::kPotential},
                                           FitCase{"H7/n6", CollisionClass::kPotential},
                                           FitCase{"H7/p6", CollisionClass::kReal}));

Interval certain_of(const OverlapResult& result) {
  Interval certain{0.0, 0.0};
  for (const OverlapRegion& region : result.regions)
    certain = {std::max(certain.lo, region.certain_mm.lo),
               std::max(certain.hi, region.certain_mm.hi)};
  return certain;
}

bool is_capped(const OverlapResult& result) {
  return std::any_of(result.regions.begin(), result.regions.end(),
                     [](const OverlapRegion& region) { return region.capped; });
}

TEST(Overlap, OnlyWhatIsCertainIsTheSameForLess) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  const FitOffsets p6 = fit_offsets("H7/p6", 10.0);
  std::uint64_t work = 0, work_of_all = 0;
  int certain = 0, none = 0, capped = 0;
  for (int i = 0; i < 60; ++i) {
    Case c;
    c.a =
        i % 3 == 0 ? solid(box({4, 5, 6}, Vec3::Zero(), 2)) : solid(peg({10, -5, 15, 32, 1, 0.1}));
    c.b = i % 3 == 0 ? solid(box({5, 4, 7}, Vec3::Zero(), 1))
                     : solid(ring({10, 0, 20, 32, 1, 0}, 20));
    if (i % 3 == 0) {
      c.band_a = uniform_band({0, 0}, {-0.02, 0.01});
      c.X_WA = Pose{rotation_exp(0.02 * Vec3(one(random), one(random), one(random))),
                    Vec3(9.0 + 0.1 * one(random), one(random), one(random))};
    } else {
      c.band_a = cylinder_band(c.a, 10, false, p6.shaft_mm);
      c.band_b = cylinder_band(c.b, 10, true, p6.hole_mm);
      c.X_WA = Pose{rotation_exp(Vec3(0.003 * one(random), 0.003 * one(random), one(random))),
                    Vec3(0.05 * one(random), 0.05 * one(random), 20.0 * one(random))};
    }
    // Some of each the other way round.
    if (i % 2 == 1) {
      std::swap(c.a, c.b);
      std::swap(c.band_a, c.band_b);
      std::swap(c.X_WA, c.X_WB);
    }
    const OverlapResult all = overlap_of(c), only = overlap_of(c, true);
    const Interval expected = certain_of(all), found = certain_of(only);
    EXPECT_TRUE(is_capped(all) || std::fabs(found.lo - expected.lo) < 2e-4)
        << i << ": " << found.lo << " against " << expected.lo;
    EXPECT_FALSE(is_capped(only)) << i;
    capped += is_capped(all);
    // Is it deeper than so much? Not asked closer to the depth than the accuracy.
    for (const double limit_mm : {0.5 * found.lo, found.lo - 3e-4, found.hi + 3e-4, 0.05}) {
      if (limit_mm <= 0.0 || (limit_mm > found.lo - 2e-4 && limit_mm < found.hi + 2e-4)) continue;
      const OverlapResult asked = overlap_of(c, true, limit_mm);
      EXPECT_EQ(certain_of(asked).lo > limit_mm, found.lo > limit_mm) << i << " " << limit_mm;
      EXPECT_EQ(certain_of(asked).hi > limit_mm, found.lo > limit_mm) << i << " " << limit_mm;
      EXPECT_LE(asked.evaluations, only.evaluations) << i << " " << limit_mm;
    }
    EXPECT_LE(found.lo, expected.hi + 1e-9) << i;
    EXPECT_GE(found.hi, expected.lo - 1e-9) << i;
    work += only.evaluations;
    work_of_all += all.evaluations;
    ++(expected.lo > 0.0 ? certain : none);
  }
  EXPECT_GT(certain, 15);
  EXPECT_LT(capped, 20);
  EXPECT_GT(none, 5);
  EXPECT_LT(2 * work, work_of_all);
}

TEST(Overlap, FakeFitNumbers) {
  Case c;
  c.a = solid(peg({10, -5, 15, 32, 1, std::numbers::pi / 32}));
  c.b = solid(ring({10, 0, 20, 32, 1, 0}, 20));
  const FitOffsets g6 = fit_offsets("H7/g6", 10.0);
  c.band_a = cylinder_band(c.a, 10, false, g6.shaft_mm);
  c.band_b = cylinder_band(c.b, 10, true, g6.hole_mm);
  c.refinement = Refinement::kDecided;
  const OverlapResult result = overlap_of(c);
  ASSERT_EQ(result.regions.size(), 1U);
  const OverlapRegion& region = result.regions[0];
  EXPECT_NEAR(region.delta_mm.lo, 0.048152733, 1e-9);
  EXPECT_NEAR(region.possible_mm.hi, -0.0035, 1e-9);
  EXPECT_NEAR(region.certain_mm.hi, -0.0205, 1e-9);
  EXPECT_EQ(region.shape_a, FaceShape::kConvex);
  EXPECT_EQ(region.shape_b, FaceShape::kConcave);
  EXPECT_LT(result.evaluations, 3000U);
  // Shifted by 3 um it still goes in; by 5 um only some do; a tilt of 2e-4 over 15 mm counts too.
  c.X_WA = Pose::translation({0.002, 0.002, 0});
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kFake);
  c.X_WA = Pose::translation({0.005, 0, 0});
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kPotential);
  c.X_WA = Pose::translation({0.021, 0, 0});
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kReal);
  c.X_WA = Pose{rotation_exp({2e-4, 0, 0}), Vec3::Zero()};
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kFake);
  c.X_WA = Pose{rotation_exp({6e-4, 0, 0}), Vec3::Zero()};
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kPotential);
}

// With only a bound on the mesh error 32 facets cannot tell, 223 can (ALG 6.3).
TEST(Overlap, DeclaredChordError) {
  const FitOffsets g6 = fit_offsets("H7/g6", 10.0);
  for (const int n : {32, 223}) {
    const double s = 10 * (1 - std::cos(std::numbers::pi / n));
    Case c;
    c.a = solid(peg({10, -5, 15, n, 1, std::numbers::pi / n}));
    c.b = solid(ring({10, 0, 20, n, 1, 0}, 20));
    c.band_a = uniform_band({0, s}, g6.shaft_mm);
    c.band_b = uniform_band({-s, 0}, g6.hole_mm);
    c.refinement = Refinement::kDecided;
    EXPECT_EQ(worst_class(overlap_of(c)),
              n == 32 ? CollisionClass::kPotential : CollisionClass::kFake);
  }
}

TEST(Overlap, BlocksWithProfileTolerance) {
  struct Row {
    double overlap_mm;
    CollisionClass expected;
  };
  for (const Row& row : {Row{0.2, CollisionClass::kReal}, Row{0.05, CollisionClass::kPotential},
                         Row{-0.05, CollisionClass::kPotential}, Row{-0.2, CollisionClass::kNone}})
    for (const int n : {1, 4}) {
      Case c{solid(box({5, 5, 5}, Vec3::Zero(), n)),
             solid(box({5, 5, 5}, {10 - row.overlap_mm, 1, 2}, 3)),
             uniform_band({}, {-.05, .05}),
             uniform_band({}, {-.05, .05}),
             Pose(),
             Pose(),
             Refinement::kDecided};
      const OverlapResult result = overlap_of(c);
      EXPECT_EQ(worst_class(result), row.expected) << row.overlap_mm << " n " << n;
      if (result.regions.empty()) continue;
      const OverlapRegion& region = result.regions[0];
      EXPECT_NEAR(region.delta_mm.lo, row.overlap_mm, 1e-6);
      EXPECT_NEAR(region.certain_mm.lo, row.overlap_mm - 0.1, 1e-6);
      EXPECT_NEAR(region.possible_mm.lo, row.overlap_mm + 0.1, 1e-6);
    }
}

// Every real verdict carries a point that an independent check finds in both least parts.
TEST(Overlap, WitnessIsInsideBoth) {
  std::mt19937_64 random(3);
  int real = 0;
  for (int i = 0; i < 40; ++i) {
    Case c{solid(box({1, .7, .4}, Vec3::Zero(), 2)),
           solid(sphere(0.8, Vec3::Zero(), 10)),
           uniform_band({}, {-.01, .01}),
           uniform_band({}, {-.02, .02}),
           random_pose(random, 0.8),
           random_pose(random, 0.8),
           Refinement::kDecided};
    const OverlapResult result = overlap_of(c);
    for (const OverlapRegion& region : result.regions) {
      if (class_of(region) != CollisionClass::kReal) continue;
      ++real;
      const Vec3 in_a = c.X_WA.inverse() * region.witness_W;
      const Vec3 in_b = c.X_WB.inverse() * region.witness_W;
      EXPECT_GT(winding_number_brute_force(c.a->mesh(), in_a), 0.5);
      EXPECT_GT(winding_number_brute_force(c.b->mesh(), in_b), 0.5);
      EXPECT_GE(nearest_point_brute_force(c.a->mesh(), in_a).distance_mm, 0.01 - 1e-9);
      EXPECT_GE(nearest_point_brute_force(c.b->mesh(), in_b).distance_mm, 0.02 - 1e-9);
    }
  }
  EXPECT_GT(real, 10);
}

}  // namespace
}  // namespace mortise
