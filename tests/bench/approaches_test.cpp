// What the benchmark of the paper's approaches stands on: exact measures of convex pieces, and the
// peers written for it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bench/approaches_pieces.h"
#include "tests/bench/gpd_pairs.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

TEST(ApproachesPieces, KnowBoxes) {
  const Pieces cube = {shapes::box({1, 1, 1})};
  const Pieces moved = placed(cube, Pose::translation({1.9, 0.3, 0.2}));
  EXPECT_NEAR(common_volume_mm3(moved, cube), 0.1 * 1.7 * 1.8, 1e-12);
  EXPECT_NEAR(translational_depth_mm(moved, cube).value(), 0.1, 1e-12);
  const Pieces away = placed(cube, Pose::translation({2.1, 0.3, 0.2}));
  EXPECT_EQ(common_volume_mm3(away, cube), 0.0);
  EXPECT_EQ(translational_depth_mm(away, cube).value(), 0.0);
}

// A part in pieces is as much as the same part in one.
TEST(ApproachesPieces, DoNotDependOnTheCut) {
  const Pieces whole = {shapes::box({2, 1, 1})},
               halves = {shapes::box({1, 1, 1}, {-1, 0, 0}), shapes::box({1, 1, 1}, {1, 0, 0})};
  std::mt19937_64 random(4);
  for (int i = 0; i < 40; ++i) {
    Pose X = shapes::random_pose(random, 1.2);
    const Pieces other = placed({shapes::box({1, 0.7, 1.5})}, X);
    EXPECT_NEAR(common_volume_mm3(other, whole), common_volume_mm3(other, halves), 1e-9) << i;
    EXPECT_NEAR(translational_depth_mm(other, whole).value(),
                translational_depth_mm(other, halves).value(), 1e-7)
        << i;
  }
}

TEST(ApproachesPieces, AgreeWithTheDifferenceOfConvexParts) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const GpdPair pair = draw_convex_pair(seed);
    EXPECT_NEAR(translational_depth_mm(placed({pair.a->mesh()}, pair.X_WA),
                                       placed({pair.b->mesh()}, pair.X_WB))
                    .value(),
                std::max(0.0, minkowski_depth_mm(pair)), 1e-8)
        << seed;
  }
}

TEST(ApproachesPieces, AKeyIsLiftedOutOfItsSlotAndAPegOutOfItsHole) {
  const Pieces key = {shapes::box({3.9, 3, 10}, {0, 3.5, 15})};
  EXPECT_EQ(translational_depth_mm(key, slot_pieces(10, 4, 8, 5, 0, 30)).value(), 0.0);
  const Pieces wide = {shapes::box({4.1, 3, 10}, {0, 3.5, 15})};
  EXPECT_NEAR(translational_depth_mm(wide, slot_pieces(10, 4, 8, 5, 0, 30)).value(), 7.5, 1e-9);
  const Pieces peg = {shapes::peg({10.01, -5, 35, 16, 1, 0})};
  EXPECT_NEAR(translational_depth_mm(peg, ring_pieces(10, 20, 0, 20, 16, 0)).value(), 25.0, 1e-9);
}

}  // namespace
}  // namespace mortise::bench
