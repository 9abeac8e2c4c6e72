#include "common/depth/generalized_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct Scene {
  SolidPtr a, b;
  Motion motion_a = still_motion(Pose()), motion_b = still_motion(Pose());
  double t_contact = 1.0;
};

GeneralizedDepth depth_of(const Scene& s, OverlapResult* overlap = nullptr) {
  const SurfaceBand nominal = nominal_band();
  GpdQuery query;
  query.overlap.a = s.a.get();
  query.overlap.b = s.b.get();
  query.overlap.band_a = query.overlap.band_b = &nominal;
  query.overlap.X_WA = s.motion_a.X_W1;
  query.overlap.X_WB = s.motion_b.X_W1;
  query.overlap.refinement = Refinement::kFull;
  query.motion_a = s.motion_a;
  query.motion_b = s.motion_b;
  query.t_contact = s.t_contact;
  CcdScratch scratch;
  const OverlapResult result = find_overlap(query.overlap, scratch);
  if (overlap != nullptr) *overlap = result;
  if (result.regions.empty()) return {};
  query.region = &result.regions[0];
  return generalized_depth(query, scratch);
}

TEST(GeneralizedDepth, CubesComeApartAlongTheNormal) {
  const GeneralizedDepth gpd =
      depth_of({solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {.9, .13, .07}))});
  EXPECT_NEAR(gpd.gpd_mm.lo, 0.1, 1e-9);
  EXPECT_GE(gpd.gpd_mm.hi, 0.1);
  EXPECT_LE(gpd.gpd_mm.hi, 0.103);
  EXPECT_NEAR(gpd.translation_mm.normalized().x(), -1.0, 1e-6);
}

// ALG 6.2.2: a sphere of radius 1 sinks 0.3 below a plane, coming at 60 degrees from its normal.
TEST(GeneralizedDepth, SphereComesInAtSixtyDegrees) {
  Scene s{solid(sphere(1, Vec3::Zero(), 32)), solid(box({10, 10, 2}, {0, 0, -2}))};
  const Vec3 end(0, 0, 0.7);
  const Vec3 way = Vec3(std::sin(std::numbers::pi / 3), 0, -std::cos(std::numbers::pi / 3));
  s.motion_a =
      linear_motion(Pose::translation(end - 1.0 * way), Pose::translation(end), Vec3::Zero());
  s.t_contact = 0.4;  // 0.6 mm before the end the lowest point meets the plane
  OverlapResult overlap;
  const GeneralizedDepth gpd = depth_of(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  EXPECT_NEAR(overlap.regions[0].delta_mm.lo, 0.3, 1e-9);
  EXPECT_NEAR(gpd.travel_mm, 0.6, 1e-9);
  EXPECT_NEAR(gpd.normal_travel_mm, 0.3, 1e-9);
  EXPECT_NEAR(gpd.gpd_mm.lo, 0.3, 1e-9);
  EXPECT_NEAR(gpd.gpd_mm.hi, 0.3, 0.006);
}

// ALG 6.2.6: a turn by 0.1 rad at 10 mm is a path of 1 mm, its chord 0.99958.
TEST(GeneralizedDepth, PathOfATurn) {
  Scene s{solid(box({10, .5, .5})), solid(box({.5, .5, .5}, {9.5, 1.2, 0}))};
  s.motion_a = linear_motion(Pose(), Pose{rotation_exp({0, 0, 0.1}), Vec3::Zero()}, Vec3::Zero());
  s.t_contact = 0.0;
  OverlapResult overlap;
  const GeneralizedDepth gpd = depth_of(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  double farthest = 0.0;
  for (const Vec3& x : overlap.regions[0].points_W)
    farthest = std::max(farthest, Vec3(x.x(), x.y(), 0).norm());
  EXPECT_NEAR(gpd.travel_mm, 0.1 * farthest, 1e-6);
  EXPECT_GT(gpd.travel_mm, 2.0 * std::sin(0.05) * farthest + 1e-4);
}

// ALG 6.2.8 in the plane: a slightly turned key is freed by a small turn; a translation alone needs
// at least as much.
TEST(GeneralizedDepth, TurnedKeyInSlot) {
  const SolidPtr slot = solid(u_slot(10, 4, 8, 5, 0, 30));
  const double angle = 0.02;
  Scene s{solid(box({3.98, 3, 10})), slot};
  s.motion_a = still_motion({rotation_exp({0, 0, angle}), {0, 3.3, 15}});
  OverlapResult overlap;
  const GeneralizedDepth gpd = depth_of(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  EXPECT_GT(gpd.gpd_mm.lo, 0.0);
  EXPECT_GE(gpd.gpd_mm.hi, gpd.gpd_mm.lo);
}

// The motion that is reported really separates, and a shorter one does not.
TEST(GeneralizedDepth, ReportedMotionSeparates) {
  const SolidPtr a = solid(box({.5, .5, .5})), b = solid(box({.5, .5, .5}, {.9, .13, .07}));
  const GeneralizedDepth gpd = depth_of({a, b});
  const auto overlaps_after = [&](double share) {
    Scene moved{a, b, still_motion(Pose::translation(share * gpd.translation_mm))};
    OverlapResult overlap;
    depth_of(moved, &overlap);
    return overlap.meshes_cross;
  };
  EXPECT_FALSE(overlaps_after(1.0));
  EXPECT_TRUE(overlaps_after(0.9));
}

}  // namespace
}  // namespace mortise
