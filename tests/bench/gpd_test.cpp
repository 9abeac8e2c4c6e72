// The generalized depth against oracles of the benchmark, shortly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/depth/depth.h"
#include "tests/bench/gpd_ask.h"
#include "tests/bench/gpd_pairs.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

TEST(GpdOracle, MinkowskiKnowsCubes) {
  const GpdPair cubes{shapes::solid(shapes::box(Vec3(1, 1, 1))),
                      shapes::solid(shapes::box(Vec3(1, 1, 1))),
                      Pose::translation({1.9, 0.3, 0.2}),
                      {}};
  EXPECT_NEAR(minkowski_depth_mm(cubes), 0.1, 1e-14);
}

TEST(GpdOracle, ConvexPairsAreClosed) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const GpdPair pair = draw_convex_pair(seed);
    const double exact = std::max(0.0, minkowski_depth_mm(pair));
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    EXPECT_NEAR(word.depth.gpd_mm.lo, exact, 1e-6) << seed;
    EXPECT_NEAR(word.depth.gpd_mm.hi, exact, 1e-6) << seed;
    EXPECT_TRUE(word.apart) << seed;
  }
}

// Asked beyond the motion that is known, holds show no more than it.
TEST(GpdOracle, HoldsAreTrueBeyondWhatIsKnown) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const bool convex = seed % 2 == 0;
    const GpdPair pair = convex ? draw_convex_pair(seed) : draw_hollow_pair(seed);
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    if (word.overlap.regions.empty()) continue;
    EXPECT_LE(holds_beyond_mm(pair, word), word.depth.gpd_mm.hi + 1e-9) << seed;
  }
}

TEST(GpdOracle, HollowPairsComeFree) {
  int closed = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const GpdPair pair = draw_hollow_pair(seed);
    const GpdWord lazy = ask_gpd(pair, Refinement::kDecided);
    EXPECT_TRUE(std::isfinite(lazy.depth.gpd_mm.hi)) << seed;
    EXPECT_TRUE(lazy.apart) << seed;
    EXPECT_TRUE(lazy.depth.gpd_mm.ordered()) << seed;
    const double reference_mm = search_longer(pair, lazy, 3);
    EXPECT_LE(lazy.depth.gpd_mm.lo, reference_mm * (1.0 + 1e-9)) << seed;
    closed += lazy.depth.gpd_mm.hi <= 1.01 * reference_mm + 2e-6;
  }
  EXPECT_GE(closed, 58);
}

}  // namespace
}  // namespace mortise::bench
