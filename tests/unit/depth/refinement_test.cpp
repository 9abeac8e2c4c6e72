// Refinement narrows a class, it never leaves it.
#include <gtest/gtest.h>

#include "tests/support/effort.h"
#include "tests/support/lofted.h"
#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr double kFlat_mm = 7.0;

// Round of the radius with a flat at x = 7, both declared exactly.
SurfaceBand d_band(const SolidPtr& solid, double radius_mm, double flat_mm, bool inward,
                   const Interval& tolerance_mm) {
  std::vector<Feature> features;
  FeatureDeclaration round{"round", {}, std::nullopt, 0.0}, flat{"flat", {}, std::nullopt, 0.0};
  round.surface.kind = SurfaceKind::kCylinder;
  round.surface.radius_mm = radius_mm;
  round.surface.inward = inward;
  flat.surface.kind = SurfaceKind::kPlane;
  flat.surface.point = Vec3(flat_mm, 0, 0);
  flat.surface.axis = inward ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitX());
  for (const FeatureDeclaration& declared : {round, flat})
    if (auto match = match_feature(solid->mesh(), declared)) features.push_back(match->feature);
  EXPECT_EQ(features.size(), 2U);
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature.assign(features.size(), {tolerance_mm, "size"});
  return build_band(input);
}

bool interferes_not(CollisionClass c) {
  return c == CollisionClass::kNone || c == CollisionClass::kFake;
}

TEST(Refinement, NarrowsAClassAndNeverLeavesIt) {
  std::mt19937_64 random(77);
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  int decided = 0;
  for (int i = 0; i < test::effort(8); ++i) {
    const int n = std::uniform_int_distribution<int>(12, 60)(random);
    const double less_mm = pick(0.0, 0.06), zone_mm = i % 2 == 0 ? 0.0 : pick(0.0, 0.02);
    OverlapCase c;
    c.a = std::make_shared<const Solid>(plate_with_hole(d_section(10.0, kFlat_mm, n), 0.0, 20.0));
    const auto section = d_section(10.0 - less_mm, kFlat_mm - less_mm, n);
    c.b =
        std::make_shared<const Solid>(lofted({at_height(section, -5.0), at_height(section, 25.0)}));
    c.band_a = d_band(c.a, 10.0, kFlat_mm, true, {-zone_mm, 0.0});
    c.band_b = d_band(c.b, 10.0 - less_mm, kFlat_mm - less_mm, false, {-zone_mm, 0.0});
    c.X_WB = Pose{rotation_exp(Vec3(0, 0, pick(-0.03, 0.03))), Vec3(pick(-0.03, 0.03), 0, 0)};
    c.refinement = Refinement::kDecided;
    const CollisionClass lazy = worst_class(overlap_of(c));
    c.refinement = Refinement::kFull;
    const CollisionClass full = worst_class(overlap_of(c));
    if (lazy == CollisionClass::kPotential) continue;
    ++decided;
    EXPECT_EQ(interferes_not(lazy), interferes_not(full)) << i;
    EXPECT_NE(full, CollisionClass::kPotential) << i;
  }
  EXPECT_GT(decided, test::effort(2));
}

}  // namespace
}  // namespace mortise
