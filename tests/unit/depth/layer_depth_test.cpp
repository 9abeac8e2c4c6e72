// The generalized depth of the least and of the largest bodies, and the class that it gives
// (common/depth/README.md, section 7).
#include "common/depth/gpd/layer_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/depth/gpd/hull_depth.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/depth_bands.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

using polyhedra::Body;
using polyhedra::Polyhedron;
using shapes::cylinder_band;
using shapes::uniform_band;

LayerDepths layers_of(const SolidPtr& a, const SurfaceBand& band_a, const SolidPtr& b,
                      const SurfaceBand& band_b, const Pose& X_BA) {
  GpdQuery query;
  query.overlap.band_a = &band_a;
  query.overlap.band_b = &band_b;
  query.overlap.X_WA = X_BA;
  query.motion_a = still_motion(X_BA);
  query.motion_b = still_motion(Pose());
  CcdScratch scratch;
  return depths_of_layers(a, b, query, scratch);
}

// Near contact of the parts as modelled: where their hulls touch along a line, and some more or
// less.
Pose near_contact(polyhedra::Random& random, const Polyhedron& a, const Polyhedron& b) {
  const Vec3 along = polyhedra::direction(random);
  Pose X{polyhedra::rotation(random), Vec3::Zero()};
  double in = 0.0, out = 30.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (in + out);
    X.p = middle * along;
    (gpd::hull_depth(*a.solid, X, *b.solid, Pose(), 1e-6).depth_mm.lo > 0.0 ? in : out) = middle;
  }
  X.p = (in + polyhedra::between(random, -0.15, 0.15)) * along;
  return X;
}

// By overlap and by generalized depth, least and largest: 0 none, 1 potential, 2 real.
void expect_one_class(polyhedra::Random& random, bool convex, int pairs) {
  int asked[3] = {0, 0, 0}, unknown = 0;
  for (int i = 0; i < pairs; ++i) {
    const auto draw = [&] {
      return convex ? polyhedra::random_convex(random) : polyhedra::random_boxes(random);
    };
    const Polyhedron a = draw(), b = draw();
    const Pose X_BA = near_contact(random, a, b);
    const double least = polyhedra::true_margin(a, b, X_BA, Body::kLeast),
                 largest = polyhedra::true_margin(a, b, X_BA, Body::kLargest);
    constexpr double kTouch_mm = 1e-5;
    if (std::fabs(least) < kTouch_mm || std::fabs(largest) < kTouch_mm) continue;
    const LayerDepths depths = layers_of(a.solid, a.band, b.solid, b.band, X_BA);
    if (!depths.least_mm || !depths.largest_mm) {
      ++unknown;
      continue;
    }
    const int by_overlap = least > 0.0 ? 2 : largest > 0.0 ? 1 : 0;
    const int by_depth = depths.least_mm->hi > 0.0 ? 2 : depths.largest_mm->hi > 0.0 ? 1 : 0;
    EXPECT_EQ(by_depth, by_overlap) << i;
    EXPECT_TRUE(depths.least_mm->ordered() && depths.largest_mm->ordered()) << i;
    EXPECT_LE(depths.least_mm->lo, depths.largest_mm->hi + 1e-9) << i;
    if (by_overlap == 2) {
      EXPECT_GE(depths.least_mm->hi, least - 1e-6) << i;
    }
    ++asked[by_overlap];
  }
  for (const int count : asked) EXPECT_GT(count, pairs / 25);
  EXPECT_LT(unknown, pairs / 4);
}

TEST(LayerDepth, GivesTheClassOfConvexPairs) {
  polyhedra::Random random(2028);
  expect_one_class(random, true, test::effort(100));
}

TEST(LayerDepth, GivesTheClassOfHollowPairs) {
  polyhedra::Random random(2029);
  expect_one_class(random, false, test::effort(60));
}

// Blocks 0.1 deep in each other, faces ±0.02: 0.06, 0.1, 0.14.
TEST(LayerDepth, BlocksAreTwoTolerancesApart) {
  const SolidPtr a = shapes::solid(shapes::box({5, 5, 5})),
                 b = shapes::solid(shapes::box({5, 5, 5}));
  const SurfaceBand band = uniform_band({}, {-0.02, 0.02});
  const LayerDepths depths = layers_of(a, band, b, band, Pose::translation({9.9, 1, 2}));
  ASSERT_TRUE(depths.least_mm && depths.largest_mm);
  EXPECT_NEAR(depths.least_mm->lo, 0.06, 1e-6);
  EXPECT_NEAR(depths.least_mm->hi, 0.06, 1e-6);
  EXPECT_NEAR(depths.largest_mm->lo, 0.14, 1e-6);
  EXPECT_NEAR(depths.largest_mm->hi, 0.14, 1e-6);
}

// A shaft of 32 facets stands for a cylinder: the brackets hold the depths of the true ones, which
// sink 0.05 and 0.15 into a block.
TEST(LayerDepth, RoundFacesAreBracketed) {
  const SolidPtr shaft = shapes::solid(shapes::peg({10, 0, 40, 32, 1, 0})),
                 block = shapes::solid(shapes::box({20, 20, 20}));
  const SurfaceBand on_shaft = cylinder_band(shaft, 10.0, false, {-0.05, 0.05}),
                    on_block = nominal_band();
  const Pose X = Pose::translation({29.9, 0, -20});
  const LayerDepths depths = layers_of(shaft, on_shaft, block, on_block, X);
  ASSERT_TRUE(depths.least_mm && depths.largest_mm);
  EXPECT_LE(depths.least_mm->lo, 0.05 + 1e-6);
  EXPECT_GE(depths.least_mm->hi, 0.05 - 1e-6);
  EXPECT_LE(depths.largest_mm->lo, 0.15 + 1e-6);
  EXPECT_GE(depths.largest_mm->hi, 0.15 - 1e-6);
  EXPECT_GT(depths.least_mm->lo, 0.0);
  EXPECT_LT(depths.largest_mm->hi, 0.15 + 0.06);  // a facet is 48 um below its arc
}

}  // namespace
}  // namespace mortise
