// The rim of a bore against chamfers and shafts, and patches between two walls: no point is deeper
// than the closed forms say, and they say no more than it takes.
#include "common/depth/search/rim.h"

#include <gtest/gtest.h>

#include <random>

#include "common/depth/search/wall_mean.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : rng_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng_); }
  Vec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Vec3 across(const Vec3& axis) {
    const Vec3 v = vector(1.0).cross(axis);
    return v.norm() > 1e-3 ? Vec3(v.normalized()) : across(axis);
  }

 private:
  std::mt19937 rng_;
};

struct Met {
  Rim rim;
  Surface round;
  double below_mm = 0.0;
};

// A bore of radius R and what nearly fits it, tilted by up to `tilt`.
Met draw_met(Draw& draw, bool shaft, double tilt_rad) {
  Met met;
  const double R = draw.in(3.0, 30.0);
  met.rim = {Vec3::Zero(), Vec3::UnitZ(), R};
  met.below_mm = draw.in(0.0, 5.0);
  met.round.kind = shaft ? SurfaceKind::kCylinder : SurfaceKind::kCone;
  met.round.axis = rotation_exp(tilt_rad * draw.across(Vec3::UnitZ())) * Vec3::UnitZ();
  met.round.radius_mm = shaft ? R + draw.in(-0.3, 0.3) : 0.0;
  met.round.half_angle_rad = shaft ? 0.0 : draw.in(0.3, 1.1);
  const Vec3 off(draw.in(-0.4, 0.4), draw.in(-0.4, 0.4), draw.in(-0.5, 0.5));
  const double apex = shaft ? 0.0 : -(R + draw.in(-0.3, 0.3)) / std::tan(met.round.half_angle_rad);
  met.round.point = off + apex * met.round.axis;
  return met;
}

// Points that may be of the rim's part: not inside the cylinder, not above the plane.
Vec3 draw_point(const Met& met, Draw& draw) {
  const bool at_rim = draw.in(0.0, 1.0) < 0.5;
  const double r = met.rim.radius_mm + (at_rim ? 0.0 : draw.in(0.0, 2.0));
  const double z = at_rim ? 0.0 : -draw.in(0.0, met.below_mm);
  return met.rim.center + r * draw.across(met.rim.axis) + z * met.rim.axis;
}

TEST(Rim, NoPointIsDeeperThanItsBound) {
  Draw draw(11);
  int bounded = 0;
  for (int i = 0; i < test::effort(4000); ++i) {
    const bool shaft = i % 2 == 0;
    const Met met = draw_met(draw, shaft, i % 3 == 0 ? 0.0 : draw.in(0.0, 0.05));
    const double bound = depth_at_rim_mm(met.rim, met.round, met.below_mm);
    if (!std::isfinite(bound)) continue;
    ++bounded;
    double deepest = -1e9;
    for (int k = 0; k < 60; ++k)
      deepest = std::max(deepest, -met.round.signed_distance_mm(draw_point(met, draw)));
    ASSERT_LE(deepest, bound + 1e-9) << "case " << i;
  }
  EXPECT_GT(bounded, test::effort(3000));
}

TEST(Rim, WithParallelAxesTheBoundIsReached) {
  Draw draw(12);
  for (int i = 0; i < 500; ++i) {
    const Met met = draw_met(draw, i % 2 == 0, 0.0);
    const double bound = depth_at_rim_mm(met.rim, met.round, met.below_mm);
    ASSERT_TRUE(std::isfinite(bound)) << i;
    double deepest = -1e9;
    for (int k = 0; k < 3600; ++k) {
      const double angle = 2.0 * 3.14159265358979323846 * k / 3600;
      const Vec3 x = met.rim.radius_mm * Vec3(std::cos(angle), std::sin(angle), 0.0);
      deepest = std::max(deepest, -met.round.signed_distance_mm(x));
    }
    EXPECT_NEAR(deepest, bound, 1e-6) << i;
  }
}

TEST(Rim, OverAMotionItHoldsAllTheWay) {
  Draw draw(13);
  int bounded = 0;
  for (int i = 0; i < test::effort(2000); ++i) {
    const Met met = draw_met(draw, i % 2 == 0, draw.in(0.0, 0.02));
    const Vec3 by = draw.vector(0.5), turn = draw.vector(i % 3 == 0 ? 0.0 : 0.01);
    const auto pose_at = [&](double t) { return Pose{rotation_exp(t * turn), t * by}; };
    // The rim's part moves, the round surface stays; points leave the straight line by less than
    // this.
    const double reach = met.rim.radius_mm + met.below_mm + 2.0;
    const double spread = 0.125 * turn.squaredNorm() * reach;
    const double bound =
        depth_at_rim_mm(met.rim.seen_from(pose_at(0.0)), met.rim.seen_from(pose_at(1.0)), met.round,
                        met.below_mm + 1.0, turn.norm(), spread);
    if (!std::isfinite(bound)) continue;
    ++bounded;
    for (int k = 0; k < 60; ++k) {
      const Vec3 x = pose_at(draw.in(0.0, 1.0)) * draw_point(met, draw);
      ASSERT_LE(-met.round.signed_distance_mm(x), bound + 1e-9) << "case " << i;
    }
  }
  EXPECT_GT(bounded, test::effort(1500));
}

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
