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

// Pegs, tilted and off the middle, whose real surfaces keep clear of the bore, often by less than 3
// um; their coarse meshes overlap in a place or two, or just do not.
TEST(Refinement, NoneAndFakeAreTheSameWords) {
  std::mt19937_64 random(4);
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  int fakes = 0, nones = 0;
  for (int i = 0; i < test::effort(40); ++i) {
    const double radius_mm = pick(2.0, 20.0), height_mm = pick(5.0, 25.0);
    const double tilt_rad = pick(0.0005, 0.02), off_mm = pick(0.0, 0.05);
    const double bore_mm =
        (radius_mm + off_mm + 0.5 * height_mm * std::sin(tilt_rad)) / std::cos(tilt_rad) +
        (i % 2 == 0 ? pick(0.0, 0.003) : pick(0.0, 0.1));
    const auto facets = [&] { return std::uniform_int_distribution<int>(6, 64)(random); };
    OverlapCase c;
    c.a = solid(ring({bore_mm, 0.0, height_mm, facets(), 1, pick(0.0, 1.0)}, 3.0 * bore_mm));
    c.b = solid(peg({radius_mm, -1.5 * height_mm, 1.5 * height_mm, facets(), 1, 0.0}));
    c.band_a = cylinder_band(c.a, bore_mm, true, {});
    c.band_b = cylinder_band(c.b, radius_mm, false, {});
    c.X_WB = {rotation_exp(Vec3(0, tilt_rad, 0)), Vec3(off_mm, 0, 0.5 * height_mm)};
    c.refinement = Refinement::kDecided;
    const CollisionClass lazy = worst_class(overlap_of(c));
    c.refinement = Refinement::kFull;
    const CollisionClass full = worst_class(overlap_of(c));
    EXPECT_EQ(lazy, full) << i;
    fakes += full == CollisionClass::kFake;
    nones += full == CollisionClass::kNone;
  }
  EXPECT_GT(fakes, test::effort(2));
  EXPECT_GT(nones, test::effort(2));
}

// Coarse pegs in bores of about their size, straight and tilted: no point between the two faces is
// deeper than their closed form.
TEST(Refinement, NarrowsTheDepthOfACoarsePeg) {
  std::mt19937_64 random(9);
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  int compared = 0;
  for (int i = 0; i < test::effort(30); ++i) {
    const double radius_mm = pick(2.0, 20.0), height_mm = pick(5.0, 25.0);
    const double tilt_rad = i % 2 == 0 ? 0.0 : pick(0.0005, 0.01);
    const double bore_mm = radius_mm + 0.5 * height_mm * tilt_rad + pick(-0.03, 0.01);
    const auto facets = [&] { return std::uniform_int_distribution<int>(6, 64)(random); };
    OverlapCase c;
    c.a = solid(ring({bore_mm, 0.0, height_mm, facets(), 1, pick(0.0, 1.0)}, 3.0 * bore_mm));
    c.b = solid(peg({radius_mm, -1.5 * height_mm, 1.5 * height_mm, facets(), 1, 0.0}));
    c.band_a = cylinder_band(c.a, bore_mm, true, {-0.01, 0.0});
    c.band_b = cylinder_band(c.b, radius_mm, false, {-0.01, 0.0});
    c.X_WB = {rotation_exp(Vec3(0, tilt_rad, 0)), Vec3(0, 0, 0.5 * height_mm)};
    c.refinement = Refinement::kDecided;
    const OverlapResult lazy = overlap_of(c);
    c.refinement = Refinement::kFull;
    const OverlapResult full = overlap_of(c);
    if (lazy.regions.empty() || full.regions.empty()) continue;
    ++compared;
    EXPECT_LE(full.regions[0].delta_mm.hi, lazy.regions[0].delta_mm.hi + kDepthAccuracyDefault_mm)
        << i;
  }
  EXPECT_GT(compared, test::effort(10));
}

}  // namespace
}  // namespace mortise
