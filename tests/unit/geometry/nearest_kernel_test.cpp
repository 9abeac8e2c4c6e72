// The vector code of the search for the nearest triangle: never above the scalar distances, and the
// same bits on every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "common/geometry/kernels/nearest.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

struct Four {
  Vec3 x;
  double corners[4][9];
  geometry::TrianglePoint point;
};

// Triangles of a millimetre, some of them needles or without area, near a point that may lie on
// one.
Four random_four(std::mt19937_64& random, int i) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto some = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  const Vec3 offset = i % 4 == 0 ? Vec3(1e5 * some()) : Vec3(Vec3::Zero());
  Four four;
  four.x = offset + 2.0 * some();
  for (auto& c : four.corners) {
    const Vec3 a = offset + some(), b = a + some();
    const double width = i % 3 == 0 ? std::pow(10.0, -8.0 + 8.0 * unit(random)) : 1.0;
    const Vec3 corner[3] = {a, b,
                            i % 17 == 0 ? b : Vec3(a + unit(random) * (b - a) + width * some())};
    for (int k = 0; k < 9; ++k) c[k] = corner[k / 3][k % 3];
    if (i % 5 == 0)
      four.x = (corner[0] + corner[1] + corner[2]) / 3.0 +
               std::pow(10.0, -6.0 + 6.0 * unit(random)) * some();
  }
  const double s = 1e-14 * (2.0 * offset.norm() + 8.0);
  four.point = {{four.x[0], four.x[1], four.x[2]}, 2e6 * s * s};
  return four;
}

TEST(NearestKernel, NoTriangleIsNearerThanItSays) {
  std::mt19937_64 random(91);
  int tight = 0, all = 0;
  for (int i = 0; i < 20000; ++i) {
    const Four four = random_four(random, i);
    double lower[4];
    geometry::portable_nearest().triangles(four.point, four.corners[0], 4, lower);
    for (int k = 0; k < 4; ++k) {
      const double* c = four.corners[k];
      const Vec3 foot =
          nearest_on_triangle(four.x, {c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]});
      const double d2 = (foot - four.x).squaredNorm();
      ASSERT_LE(lower[k], d2) << "case " << i << ", triangle " << k;
      ++all;
      tight += lower[k] > 0.999 * d2;
    }
  }
  EXPECT_GT(tight, all / 2) << "not so timid as to be useless";
}

TEST(NearestKernel, NoBoxIsNearerThanItSays) {
  std::mt19937_64 random(92);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  for (int i = 0; i < 5000; ++i) {
    float center[3][8], half[3][8], lower[8];
    geometry::BoxPoint point{{2.0F * unit(random), 2.0F * unit(random), 2.0F * unit(random)},
                             3e-6F};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 8; ++k) center[c][k] = unit(random), half[c][k] = std::fabs(unit(random));
    const float limit = std::fabs(unit(random));
    const unsigned near = geometry::portable_nearest().boxes(point, center, half, limit, lower);
    for (int k = 0; k < 8; ++k) {
      double d2 = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double gap = std::fabs(static_cast<double>(point.x[c]) - center[c][k]) - half[c][k];
        d2 += gap > 0.0 ? gap * gap : 0.0;
      }
      ASSERT_LE(lower[k], d2);
      ASSERT_EQ((near >> k & 1U) != 0, lower[k] <= limit);
    }
  }
}

TEST(NearestKernel, WideAndPortableAgreeToTheLastBit) {
  if (geometry::wide_nearest() == nullptr)
    GTEST_SKIP() << "machine: no AVX2, the portable kernel is the only one";
  std::mt19937_64 random(93);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  for (int i = 0; i < 20000; ++i) {
    const Four four = random_four(random, i);
    double x[4], y[4];
    geometry::portable_nearest().triangles(four.point, four.corners[0], 1 + i % 4, x);
    geometry::wide_nearest()->triangles(four.point, four.corners[0], 1 + i % 4, y);
    ASSERT_EQ(std::memcmp(x, y, sizeof x), 0) << i;
    float center[3][8], half[3][8], p[8], q[8];
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 8; ++k) center[c][k] = unit(random), half[c][k] = std::fabs(unit(random));
    const geometry::BoxPoint point{{unit(random), unit(random), unit(random)}, 1e-6F};
    const float limit = std::fabs(unit(random));
    ASSERT_EQ(geometry::portable_nearest().boxes(point, center, half, limit, p),
              geometry::wide_nearest()->boxes(point, center, half, limit, q));
    ASSERT_EQ(std::memcmp(p, q, sizeof p), 0) << i;
  }
}

}  // namespace
}  // namespace mortise
