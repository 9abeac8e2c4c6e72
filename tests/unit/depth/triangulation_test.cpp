// Refining a mesh must not change the depth: the same bodies, cut ever finer and at random, have
// their exact depth within 1e-4 mm, in any pose and either order.
#include <gtest/gtest.h>

#include "common/depth/depth.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/support/known_depths.h"
#include "tests/support/refine.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr double kAccuracy_mm = 1e-4;

struct Found {
  std::size_t regions = 0;
  Interval delta_mm;
  bool capped = false;
};

Found depth_of(const SolidPtr& a, const SolidPtr& b, const Pose& X_W) {
  const SurfaceBand nominal = nominal_band();
  OverlapQuery query;
  query.a = a.get();
  query.b = b.get();
  query.band_a = query.band_b = &nominal;
  query.X_WA = query.X_WB = X_W;
  query.refinement = Refinement::kFull;
  // The cap is about cost. A few random cuts full of slivers need more than is usual.
  query.work_cap = 20'000'000;
  CcdScratch scratch;
  const OverlapResult result = find_overlap(query, scratch);
  Found found;
  found.regions = result.regions.size();
  if (found.regions == 0) return found;
  found.delta_mm = result.regions.front().delta_mm;
  for (const OverlapRegion& region : result.regions) {
    found.delta_mm.hi = std::max(found.delta_mm.hi, region.delta_mm.hi);
    found.capped |= region.capped;
  }
  return found;
}

void expect_exact(const Found& found, double depth_mm, const std::string& name) {
  ASSERT_GT(found.regions, 0U) << name;
  EXPECT_FALSE(found.capped) << name;
  // Rounding at the distance of the random poses.
  EXPECT_LE(found.delta_mm.lo, depth_mm + 1e-9) << name;
  EXPECT_GE(found.delta_mm.hi, depth_mm - 1e-9) << name;
  EXPECT_NEAR(found.delta_mm.lo, depth_mm, kAccuracy_mm * 1.000001) << name;
  EXPECT_NEAR(found.delta_mm.hi, depth_mm, kAccuracy_mm * 1.000001) << name;
}

TEST(Triangulation, RefiningAMeshMustNotChangeTheDepth) {
  std::mt19937_64 random(31);
  for (const int n : {1, 2, 4, 7})
    for (const KnownDepth& known : known_depths(n)) {
      const SolidPtr a = solid(known.a), b = solid(known.b);
      const Pose X_W = random_pose(random, 100.0);
      const std::string name = known.name + ", n " + std::to_string(n);
      expect_exact(depth_of(a, b, X_W), known.depth_mm, name);
      expect_exact(depth_of(b, a, X_W), known.depth_mm, name + ", swapped");
    }
}

TEST(Triangulation, NorDoesCuttingItAtRandom) {
  std::mt19937_64 random(32);
  for (int round = 0; round < test::effort(1); ++round)
    for (const KnownDepth& known : known_depths(1)) {
      const SolidPtr a = solid(refined(known.a, 60, random));
      const SolidPtr b = solid(refined(known.b, 60, random));
      expect_exact(depth_of(a, b, random_pose(random, 100.0)), known.depth_mm,
                   known.name + ", round " + std::to_string(round));
    }
}

// The check sees a depth that is 2e-4 mm off.
TEST(Triangulation, APlantedErrorIsSeen) {
  const KnownDepth known = known_depths(1).front();
  const Found found = depth_of(solid(known.a), solid(known.b), Pose());
  const double planted_mm = known.depth_mm + 2.0 * kAccuracy_mm;
  EXPECT_GT(std::abs(found.delta_mm.lo - planted_mm), kAccuracy_mm);
}

// What the depth is held against: the deepest vertex does change.
TEST(Triangulation, TheDeepestVertexChanges) {
  double least = 1e9, most = -1e9;
  for (const int n : {1, 2, 4, 7}) {
    const KnownDepth known = known_depths(n)[2];
    const SolidPtr b = solid(known.b);
    double deepest = 0.0;
    for (const Vec3& x : known.a.points_mm) deepest = std::max(deepest, -signed_distance_mm(*b, x));
    least = std::min(least, deepest);
    most = std::max(most, deepest);
  }
  EXPECT_GT(most - least, 0.05);
}

}  // namespace
}  // namespace mortise
