#include "common/depth/search/face_below.h"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/overlap_case.h"

// What a face below a box bounds is asked of the nearest point of the mesh itself.
namespace mortise {
namespace {

using namespace shapes;

FaceBelow::Corners corners_of(const Vec3& center, const Vec3& half) {
  FaceBelow::Corners corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = center + Vec3(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                               i & 4 ? half.z() : -half.z());
  return corners;
}

TEST(FaceBelow, NoPointOfTheBoxIsDeeper) {
  std::mt19937_64 random(29);
  const auto u = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const SolidPtr parts[] = {solid(u_slot(2, 0.7, 1, 0.6, -1, 1)),
                            solid(box({2, 1.5, 1}, Vec3::Zero(), 3)),
                            solid(ring({1, -1, 1, 12}, 2)), solid(peg({1.5, -1, 1, 8}))};
  int held = 0;
  for (int i = 0; i < test::effort(20'000); ++i) {
    const Solid& part = *parts[i % 4];
    const Vec3 center(u(-2, 2), u(-2, 2), u(-1.2, 1.2));
    const SurfacePoint at = nearest_surface(part, center);
    if (at.depth_mm <= 0.0) continue;
    const Vec3 half = Vec3(u(0.01, 1), u(0.01, 1), u(0.01, 1)) * u(0.1, 1);
    FaceBelow face(part, at.triangle);
    if (!face.holds(corners_of(center, half), center)) continue;
    ++held;
    for (int j = 0; j < 8; ++j) {
      const Vec3 x = center + Vec3(u(-1, 1), u(-1, 1), u(-1, 1)).cwiseProduct(half);
      ASSERT_LE(-signed_distance_mm(part, x), face.distance_mm(x) + 1e-9) << i;
    }
  }
  EXPECT_GT(held, 2000);
}

// Beside the face the material goes on: a plane there would bound nothing.
TEST(FaceBelow, AnEdgeBelowEndsIt) {
  const SolidPtr cube = solid(box({1, 1, 1}, Vec3::Zero(), 2));
  const Vec3 center(0.2, 0.1, 0.5);
  const std::uint32_t top = nearest_surface(*cube, center).triangle;
  EXPECT_TRUE(FaceBelow(*cube, top).holds(corners_of(center, {0.5, 0.5, 0.2}), center));
  EXPECT_FALSE(FaceBelow(*cube, top).holds(corners_of(center, {0.9, 0.5, 0.2}), center));
}

}  // namespace
}  // namespace mortise
