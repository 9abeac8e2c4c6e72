#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "common/depth/depth.h"
#include "common/geometry/signed_distance.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

SolidPtr block(double x_mm, double y_mm, double z_mm) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.points_mm.emplace_back((i & 1 ? 0.5 : -0.5) * x_mm, (i & 2 ? 0.5 : -0.5) * y_mm,
                                (i & 4 ? 0.5 : -0.5) * z_mm);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return std::make_shared<const Solid>(std::move(mesh));
}

/// Every point of the lower face of the block is equally deep, its corners too: from there a move
/// along a face normal runs along the next face and never comes inside.
TEST(Witness, IsFoundWhereTheDeepestPointIsACorner) {
  const SolidPtr base = block(100, 100, 10), small = block(10, 10, 10);
  const SurfaceBand band = nominal_band();
  std::mt19937_64 random(5);
  const auto uniform = [&](double half) {
    return half * (static_cast<double>(random() >> 11) * 0x1.0p-52 - 1.0);
  };
  for (int i = 0; i < 20; ++i) {
    // Random rigid motion of both, and turns of the small one about the common normal.
    const Pose X_W{rotation_exp(Vec3(uniform(1.5), uniform(1.5), uniform(1.5))),
                   Vec3(uniform(1e3), uniform(1e3), uniform(1e3))};
    const double depth_mm = i % 2 ? 1.0 : 1e-3;
    const Pose X_BS{rotation_exp(Vec3(0, 0, i < 4 ? 0.0 : uniform(3.0))),
                    Vec3(20, i < 4 ? 0.0 : uniform(20), 10.0 - depth_mm)};
    OverlapQuery query;
    query.a = base.get();
    query.b = small.get();
    query.band_a = query.band_b = &band;
    query.X_WA = i == 0 ? Pose{} : X_W;
    query.X_WB = query.X_WA * X_BS;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    ASSERT_FALSE(result.regions.empty()) << i;
    const OverlapRegion& region = result.regions.front();
    EXPECT_GT(region.certain_mm.lo, 0.9 * depth_mm) << i;
    ASSERT_TRUE(region.has_witness) << i;
    for (const auto& [solid, X_WP] : {std::pair(base, query.X_WA), std::pair(small, query.X_WB)}) {
      EXPECT_LT(signed_distance_mm(*solid, X_WP.inverse() * region.witness_W), 0.0) << i;
    }
  }
}

}  // namespace
}  // namespace mortise
