// Patches between two walls: no point of one that is kept off is below both.
#include "common/depth/search/wall_mean.h"

#include <gtest/gtest.h>

#include <random>

#include "common/math/rotation.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : rng_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng_); }
  Vec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937 rng_;
};

// A ring of points and circles about a bore's rim, as a patch of a chamfer is seen.
TEST(WallMean, NoPointOfAPatchThatIsKeptOffIsBelowBothWalls) {
  Draw draw(14);
  int kept_off = 0, denied = 0;
  for (int i = 0; i < test::effort(4000); ++i) {
    Surface bore;
    bore.kind = SurfaceKind::kCylinder;
    bore.axis = Vec3::UnitZ();
    bore.radius_mm = draw.in(3.0, 20.0);
    bore.inward = true;
    Patch patch;
    const Pose X{rotation_exp(draw.vector(i % 2 == 0 ? 0.0 : 0.01)), draw.vector(0.3)};
    const double lo = draw.in(-1.0, -0.1), hi = draw.in(0.1, 1.0), shift = draw.in(-0.5, 0.4);
    for (const double z : {lo, hi})
      patch.circles[patch.circle_count++] = {X * Vec3(0, 0, z), X.q * Vec3::UnitZ(),
                                             bore.radius_mm + z + shift, false};
    std::vector<Vec3> surface;  // the cone between the circles, over a quarter of it
    const double from = draw.in(0.0, 6.0);
    for (int k = 0; k < 80; ++k) {
      const double angle = from + draw.in(0.0, 1.5), z = k % 4 == 0   ? lo
                                                         : k % 4 == 1 ? hi
                                                                      : draw.in(lo, hi);
      const double r = bore.radius_mm + z + shift;
      surface.push_back(X * Vec3(r * std::cos(angle), r * std::sin(angle), z));
    }
    patch.center = surface.front();
    patch.normal = X.q * Vec3::UnitX();
    patch.turn_rad = 2.0;
    patch.bulge_mm = bore.radius_mm;  // only the circles say anything
    for (int k = 0; k < 4; ++k) patch.points[patch.count++] = surface[k];
    patch.radius_mm = 2.0 * bore.radius_mm;
    ConvexWall plane, hollow;
    plane.normal = Vec3::UnitZ();
    plane.offset_mm = draw.in(-0.05, 0.05);
    hollow.surface = &bore;
    hollow.normal = bore.outward_normal(patch.center);
    hollow.turn_rad = 1.0;
    hollow.offset_mm = draw.in(-0.05, 0.05);
    const double limit = draw.in(-0.05, 0.05);
    double deepest = -1e9;
    for (const Vec3& x : surface)
      deepest = std::max(deepest, std::min(plane.depth_mm(x), hollow.depth_mm(x)));
    if (mean_keeps_off(plane, hollow, patch, limit)) {
      ++kept_off;
      ASSERT_LE(deepest, limit + 1e-9) << "case " << i;
    } else if (deepest > limit) {
      ++denied;
    }
  }
  EXPECT_GT(kept_off, test::effort(800));
  EXPECT_GT(denied, test::effort(300));
}

// Of circles below two planes: where some mean of both depths is no larger on any of them, and only
// there.
TEST(WallMean, CirclesAreKeptOffWhereSomeMeanIsNoLarger) {
  Draw draw(15);
  int inner = 0;
  for (int i = 0; i < test::effort(2000); ++i) {
    Patch patch;
    for (int k = 0; k <= i % 3; ++k)
      patch.circles[patch.circle_count++] = {draw.vector(3.0), draw.vector(1.0).normalized(),
                                             draw.in(0.5, 10.0), 0.0};
    patch.points[patch.count++] = patch.center = patch.circles[0].center;
    patch.turn_rad = 2.0;
    patch.bulge_mm = 100.0;  // only the circles say anything
    ConvexWall first, second;
    for (ConvexWall* wall : {&first, &second}) {
      wall->normal = draw.vector(1.0).normalized();
      wall->point = draw.vector(5.0);
    }
    double least = kInfinity, least_share = 0.0;
    constexpr int kShares = 2000;
    for (int k = 0; k <= kShares; ++k) {
      const double share = static_cast<double>(k) / kShares;
      const Vec3 down = -(1.0 - share) * first.normal - share * second.normal;
      double most = -kInfinity;
      for (int c = 0; c < patch.circle_count; ++c) {
        const Patch::Circle& circle = patch.circles[c];
        most = std::max(most, (1.0 - share) * first.depth_mm(circle.center) +
                                  share * second.depth_mm(circle.center) +
                                  circle.radius_mm * down.cross(circle.axis).norm());
      }
      if (most < least) least_share = share;
      least = std::min(least, most);
    }
    inner += least_share > 0.0 && least_share < 1.0 ? 1 : 0;
    EXPECT_TRUE(mean_keeps_off(first, second, patch, least + 0.05)) << "case " << i;
    EXPECT_FALSE(mean_keeps_off(first, second, patch, least - 0.05)) << "case " << i;
  }
  EXPECT_GT(inner, test::effort(400));
}

}  // namespace
}  // namespace mortise
