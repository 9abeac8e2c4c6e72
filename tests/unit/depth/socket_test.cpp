#include <gtest/gtest.h>

#include <random>

#include "common/depth/depth.h"
#include "common/depth/search/face_pair.h"
#include "common/math/rotation.h"
#include "tests/support/numbers.h"
#include "tests/support/turned_part.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

Surface sphere(double radius_mm, bool inward) {
  Surface surface;
  surface.kind = SurfaceKind::kSphere;
  surface.radius_mm = radius_mm;
  surface.inward = inward;
  return surface;
}

SurfaceBand sphere_band(const SolidPtr& solid, double radius_mm, bool inward, Interval offset_mm) {
  FeatureDeclaration declared;
  declared.name = inward ? "socket" : "ball";
  declared.surface = sphere(radius_mm, inward);
  const auto match = match_feature(solid->mesh(), declared);
  if (!match) return nominal_band();
  const std::vector<Feature> features = {match->feature};
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature = {{offset_mm, "zone"}};
  return build_band(input);
}

// A ring whose hole is a zone of a sphere about the origin, between two elevations.
SolidPtr socket_ring(double radius_mm, const Interval& elevation_rad, int facets) {
  Chain hole, outside;
  hole.inward = true;
  const double z0 = radius_mm * std::sin(elevation_rad.lo);
  const double z1 = radius_mm * std::sin(elevation_rad.hi);
  hole.start(radius_mm * std::cos(elevation_rad.lo), z0);
  hole.arc(0.0, 0.0, elevation_rad.hi, facets / 4);
  outside.start(2.0 * radius_mm, z0).line(2.0 * radius_mm, z1);
  return solid(turned_part(outside, hole, facets));
}

// A ball; its poles are cut off far from any rim.
SolidPtr ball(double radius_mm, int facets) {
  Chain outside, inside;
  const double high = 0.45 * kPi, z = radius_mm * std::sin(high);
  outside.start(radius_mm * std::cos(high), -z).arc(0.0, 0.0, high, facets / 2);
  inside.start(0.02 * radius_mm, -z).line(0.02 * radius_mm, z);
  return solid(turned_part(outside, inside, facets));
}

// No point between the planes and outside the sphere is deeper in the ball than the bound, and some
// point comes near it.
TEST(Socket, TheBoundBeyondItIsReached) {
  std::mt19937_64 random(99);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Surface socket = sphere(10.0, true);
  for (int i = 0; i < 200; ++i) {
    Surface ball = sphere(9.9, false);
    ball.point = 0.3 * Vec3(unit(random), unit(random), unit(random));
    const double middle = 5.0 * unit(random);
    const FaceExtent extent{middle - 3.0, middle + 3.0};
    const double margin = 0.05 * (1.0 + unit(random));
    const auto bound = beyond_socket(ball, socket, extent, margin);
    ASSERT_TRUE(bound);
    EXPECT_DOUBLE_EQ(bound->along_mm.hi, extent.hi_mm + margin);
    double deepest = -1e9;
    for (int s = 0; s < 20'000; ++s) {
      const double z = bound->along_mm.middle() + 0.5 * bound->along_mm.width() * unit(random);
      const double out = 10.0 * (1.0 + 1e-3 * (s % 4)), angle = kPi * unit(random);
      const double r = std::sqrt(out * out - z * z);
      const Vec3 x(r * std::cos(angle), r * std::sin(angle), z);
      deepest = std::max(deepest, ball.radius_mm - (x - ball.point).norm());
    }
    EXPECT_LE(deepest, bound->depth_mm + 1e-12);
    EXPECT_GT(deepest, bound->depth_mm - 5e-3);
  }
}

TEST(Socket, ARimInAPlaneEndsTheFaceExactly) {
  const SolidPtr ring = socket_ring(10.0, {-0.6, 0.3}, 24);
  const SurfaceBand band = sphere_band(ring, 10.0, true, {});
  ASSERT_EQ(band.faces.size(), 2u);
  const FaceEnds ends = Body(*ring, band).ends_of(1);
  EXPECT_TRUE(ends.level[0]);
  EXPECT_TRUE(ends.level[1]);
  EXPECT_NEAR(ends.extent_mm.hi, 10.0 * std::sin(0.3), 1e-12);
  // One corner of the rim off its plane: the border may go higher than its corners.
  TriangleMesh bent = ring->mesh();
  for (Vec3& x : bent.points_mm)
    if (x.y() == 0.0 && x.x() > 0.0 && std::fabs(x.norm() - 10.0) < 1e-9 &&
        std::fabs(x.z() - ends.extent_mm.hi) < 1e-9)
      x = 10.0 * Vec3(std::cos(0.29), 0.0, std::sin(0.29));
  const SolidPtr other = solid(bent);
  const SurfaceBand of_other = sphere_band(other, 10.0, true, {});
  ASSERT_EQ(of_other.faces.size(), 2u);
  EXPECT_TRUE(Body(*other, of_other).ends_of(1).level[0]);
  EXPECT_FALSE(Body(*other, of_other).ends_of(1).level[1]);
}

struct Pushed {
  double clearance_mm;  // of the true radii
  double push_mm;       // of the ball, towards an elevation above the rim
  bool meets;
};

// The ball is pushed past the rim, where its deepest point would be: the rim decides.
TEST(Socket, TheRimDecidesWhereTheBallIsPushedPastIt) {
  constexpr double kRim = 0.3, kPush = 0.8;
  const SolidPtr ring = socket_ring(10.0, {-0.6, kRim}, 24), inner = ball(10.0, 24);
  const double across = std::cos(kPush - kRim);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-3.0, 3.0);
  for (const Pushed& p : {Pushed{0.1, 0.09 / across, false}, Pushed{0.1, 0.0995 / across, false},
                          Pushed{0.1, 0.102 / across, true}, Pushed{0.1, 0.12 / across, true}}) {
    const SurfaceBand hollow = sphere_band(ring, 10.0, true, {0.0, 0.0});
    const SurfaceBand round = sphere_band(inner, 10.0, false, {-p.clearance_mm, -p.clearance_mm});
    OverlapQuery query;
    query.a = inner.get();
    query.b = ring.get();
    query.band_a = &round;
    query.band_b = &hollow;
    query.X_WB = {rotation_exp(Vec3(unit(random), unit(random), unit(random))),
                  10.0 * Vec3(unit(random), unit(random), unit(random))};
    query.X_WA =
        query.X_WB * Pose::translation(p.push_mm * Vec3(std::cos(kPush), 0.0, std::sin(kPush)));
    query.work_cap = 10'000;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    // The rim's distance from the ball's centre.
    const Vec3 rim = 10.0 * Vec3(std::cos(kRim), 0.0, std::sin(kRim));
    const Vec3 center = p.push_mm * Vec3(std::cos(kPush), 0.0, std::sin(kPush));
    const double truth = 10.0 - p.clearance_mm - (rim - center).norm();
    ASSERT_EQ(truth > 0.0, p.meets);
    double certain = -1e9, certain_hi = -1e9, possible = -1e9;
    for (const OverlapRegion& region : result.regions) {
      EXPECT_FALSE(region.capped);
      certain = std::max(certain, region.certain_mm.lo);
      certain_hi = std::max(certain_hi, region.certain_mm.hi);
      possible = std::max(possible, region.possible_mm.hi);
      if (region.certain_mm.lo > 0.0) {
        EXPECT_TRUE(region.has_witness);
      }
    }
    if (p.meets) {
      // Lazily the bracket may be wide, but it holds the truth.
      EXPECT_NEAR(certain, truth, 0.05 * truth) << p.push_mm;
      EXPECT_LE(certain, truth + 1e-9) << p.push_mm;
      EXPECT_GE(certain_hi, truth - 1e-9) << p.push_mm;
    } else {
      EXPECT_LE(possible, 0.0) << p.push_mm;
    }
  }
}

}  // namespace
}  // namespace mortise
