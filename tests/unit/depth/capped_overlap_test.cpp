// Where the work of an overlap is cut short, its brackets are wide and never wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "common/depth/depth.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct Scene {
  SolidPtr a, b;
  SurfaceBand band_a = nominal_band(), band_b = nominal_band();
  Pose X_WA = Pose();
};

// Deep in each other, so that most triangles that lie inside are far from the other surface.
Scene random_scene(std::mt19937_64& random, int i) {
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  Scene scene;
  scene.a =
      i % 2 == 0 ? solid(box({3, 2, 4}, Vec3::Zero(), 5)) : solid(sphere(3.0, Vec3::Zero(), 10));
  scene.b =
      i % 3 == 0 ? solid(box({2, 5, 3}, Vec3::Zero(), 5)) : solid(sphere(4.0, Vec3::Zero(), 10));
  if (i % 4 >= 2) {
    scene.band_a = uniform_band({}, {-0.05, 0.02});
    scene.band_b = uniform_band({}, {-0.01, 0.03});
  }
  scene.X_WA = {rotation_exp(2.0 * Vec3(one(random), one(random), one(random))),
                4.5 * Vec3(one(random), one(random), one(random))};
  return scene;
}

OverlapResult overlap_of(const Scene& scene, Refinement refinement, std::uint64_t work_cap,
                         bool only_certain) {
  OverlapQuery query;
  query.a = scene.a.get();
  query.b = scene.b.get();
  query.band_a = &scene.band_a;
  query.band_b = &scene.band_b;
  query.X_WA = scene.X_WA;
  query.refinement = refinement;
  query.work_cap = work_cap;
  query.only_certain = only_certain;
  CcdScratch scratch;
  return find_overlap(query, scratch);
}

// Deepest of all regions. Nothing is told of what is known not to overlap.
Interval deepest(const OverlapResult& result, Interval OverlapRegion::*bracket) {
  Interval found{-std::numeric_limits<double>::infinity(), 0.0};
  for (const OverlapRegion& region : result.regions)
    found = {std::max(found.lo, (region.*bracket).lo), std::max(found.hi, (region.*bracket).hi)};
  return found;
}

TEST(CappedOverlap, BracketsHoldTheDepthThatMoreWorkFinds) {
  std::mt19937_64 random(5);
  int capped = 0, deep = 0;
  for (int i = 0; i < test::effort(12); ++i) {
    const Scene scene = random_scene(random, i);
    const OverlapResult whole_with_inside = overlap_of(scene, Refinement::kFull, 40'000, false);
    // What is certain is asked of the surfaces alone.
    const OverlapResult whole_surfaces = overlap_of(scene, Refinement::kFull, 40'000, true);
    for (const std::uint64_t cap : {20, 100, 300, 1'000})
      for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull})
        for (const bool only_certain : {false, true}) {
          const OverlapResult cut = overlap_of(scene, refinement, cap, only_certain);
          const OverlapResult& whole = only_certain ? whole_surfaces : whole_with_inside;
          const auto expect_holds = [&](Interval OverlapRegion::*bracket) {
            const Interval truth = deepest(whole, bracket), found = deepest(cut, bracket);
            // Lazily what lies deeper inside than at the surfaces may be left out.
            if (only_certain || refinement == Refinement::kFull) {
              EXPECT_GE(found.hi, truth.lo - 1e-9) << i << " " << cap << " " << only_certain;
            }
            EXPECT_LE(found.lo, std::max(0.0, truth.hi) + 1e-9) << i << " " << cap;
          };
          expect_holds(&OverlapRegion::certain_mm);
          if (only_certain) continue;
          expect_holds(&OverlapRegion::delta_mm);
          expect_holds(&OverlapRegion::possible_mm);
          for (const OverlapRegion& region : cut.regions) capped += region.capped;
        }
    deep += deepest(whole_with_inside, &OverlapRegion::delta_mm).lo > 0.5;
  }
  EXPECT_GT(capped, test::effort(25));
  EXPECT_GT(deep, test::effort(4));
}

}  // namespace
}  // namespace mortise
