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

}  // namespace
}  // namespace mortise
