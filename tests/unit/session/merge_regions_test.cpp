#include "common/session/tick/merge_regions.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

// faces: 0 the rest, 1 a round face of radius 10, 2 a plane; triangle i belongs to face i.
SurfaceBand three_faces() {
  SurfaceBand band;
  band.faces.resize(3);
  band.faces[1].surface = Surface{.kind = SurfaceKind::kCylinder, .radius_mm = 10.0};
  band.faces[2].surface = Surface{.kind = SurfaceKind::kPlane};
  band.face_of_triangle = {0, 1, 2};
  return band;
}

OverlapRegion region(std::uint32_t face_a, std::uint32_t face_b, double depth_mm, const Vec3& at) {
  OverlapRegion r;
  r.delta_mm = {depth_mm, depth_mm + 0.001};
  r.certain_mm = {depth_mm - 0.1, depth_mm - 0.05};
  r.possible_mm = {depth_mm + 0.05, depth_mm + 0.1};
  r.deciding_triangle_a = face_a;
  r.deciding_triangle_b = face_b;
  r.point_W = at;
  r.area_mm2 = 1.0;
  return r;
}

TEST(MergeRegions, FacetsOfOneFitAreOneCollision) {
  const SurfaceBand band = three_faces();
  std::vector<OverlapRegion> regions;
  for (int i = 0; i < 32; ++i) regions.push_back(region(1, 1, 0.02 + 0.001 * i, Vec3(i, 0, 0)));
  const auto merged = merge_regions(regions, band, band);
  ASSERT_EQ(merged.size(), 1U);
  EXPECT_DOUBLE_EQ(merged[0].area_mm2, 32.0);
  EXPECT_DOUBLE_EQ(merged[0].delta_mm.lo, 0.051);
  EXPECT_DOUBLE_EQ(merged[0].possible_mm.hi, 0.151);
  EXPECT_EQ(merged[0].point_W, Vec3(31, 0, 0));  // the worst one's place
}

TEST(MergeRegions, OtherFacesAndFarPlacesStayApart) {
  const SurfaceBand band = three_faces();
  EXPECT_EQ(
      merge_regions({region(1, 1, 0.2, Vec3::Zero()), region(1, 2, 0.1, Vec3::Zero())}, band, band)
          .size(),
      2U);
  // Against undeclared faces only what lies on one circle is one collision.
  EXPECT_EQ(merge_regions({region(1, 0, 0.2, Vec3(-10, 0, 0)), region(1, 0, 0.1, Vec3(10, 0, 0))},
                          band, band)
                .size(),
            1U);
  EXPECT_EQ(merge_regions({region(1, 0, 0.2, Vec3(-10, 0, 0)), region(1, 0, 0.1, Vec3(30, 0, 0))},
                          band, band)
                .size(),
            2U);
  EXPECT_EQ(
      merge_regions({region(0, 0, 0.2, Vec3::Zero()), region(0, 0, 0.1, Vec3::Zero())}, band, band)
          .size(),
      2U);
}

TEST(MergeRegions, AWitnessIsNotLost) {
  const SurfaceBand band = three_faces();
  OverlapRegion real = region(1, 1, 0.2, Vec3(5, 0, 0));
  real.has_witness = true;
  real.witness_W = Vec3(5, 0, 1);
  const auto merged = merge_regions({region(1, 1, 0.3, Vec3::Zero()), real}, band, band);
  ASSERT_EQ(merged.size(), 1U);
  EXPECT_TRUE(merged[0].has_witness);
  EXPECT_EQ(merged[0].witness_W, Vec3(5, 0, 1));
  EXPECT_DOUBLE_EQ(merged[0].delta_mm.lo, 0.3);
}

}  // namespace
}  // namespace mortise
