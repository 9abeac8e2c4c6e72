// Rounding of files, cracks of meshes, and parts that lie wholly in others.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;

/// Nothing is said of the part; the corners of its file may be off by so much.
SurfaceBand rounded_band(const SolidPtr& part, double quantum_mm) {
  BandInput input;
  input.solid = part.get();
  input.quantum_mm = quantum_mm;
  return build_band(input);
}

OverlapCase stacked(double overlap_mm, double quantum_mm, Refinement refinement) {
  OverlapCase c{solid(box({10, 10, 10})), solid(box({4, 5, 6}, {1, 2, 16.0 - overlap_mm}))};
  c.band_a = rounded_band(c.a, quantum_mm);
  c.band_b = rounded_band(c.b, quantum_mm);
  c.refinement = refinement;
  return c;
}

TEST(FileRounding, ContactWithinItIsNeverReal) {
  constexpr double kQuantum_mm = 5e-4;
  for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
    const auto at = [&](double overlap_mm) {
      return worst_class(overlap_of(stacked(overlap_mm, kQuantum_mm, refinement)));
    };
    EXPECT_EQ(at(-1e-4), CollisionClass::kNone);
    EXPECT_EQ(at(0.0), CollisionClass::kNone);  // rounding alone makes no collision
    EXPECT_EQ(at(1e-4), CollisionClass::kPotential);
    EXPECT_EQ(at(0.99e-3), CollisionClass::kPotential);
    EXPECT_EQ(at(1.2e-3), CollisionClass::kReal);
    EXPECT_EQ(at(1.0), CollisionClass::kReal);
  }
  EXPECT_EQ(worst_class(overlap_of(stacked(1e-4, 0.0, Refinement::kFull))), CollisionClass::kReal);
}

TEST(FileRounding, IsPartOfEveryOffset) {
  const SolidPtr part = solid(box({10, 10, 10}));
  const SurfaceBand plain = rounded_band(part, 1e-3);
  EXPECT_TRUE(plain.trivial);
  EXPECT_EQ(plain.largest_offset_mm, 1e-3);
  BandInput input;
  input.solid = part.get();
  input.quantum_mm = 1e-3;
  input.rest = {{-0.1, 0.1}, "±0.1 mm"};
  const SurfaceBand said = build_band(input);
  EXPECT_FALSE(said.trivial);
  EXPECT_NEAR(said.largest_offset_mm, 0.101, 1e-12);
  // A declared cylinder is the truth, whatever the corners of the mesh.
  const SolidPtr round = solid(peg({10, -5, 15, 32, 1, 0}));
  FeatureDeclaration declared;
  declared.name = "shaft";
  declared.surface.kind = SurfaceKind::kCylinder;
  declared.surface.radius_mm = 10;
  const auto match = match_feature(round->mesh(), declared);
  ASSERT_TRUE(match);
  const std::vector<Feature> features = {match->feature};
  BandInput of_round;
  of_round.solid = round.get();
  of_round.features = features;
  of_round.of_feature = {{}};
  const SurfaceBand exact = build_band(of_round);
  of_round.quantum_mm = 1e-3;
  const SurfaceBand rounded = build_band(of_round);
  EXPECT_EQ(rounded.faces[1].deviation_mm, exact.faces[1].deviation_mm);
  // Its steepest facets are half a facet off 45 degrees: both coordinates of a corner count.
  const double askew_mm = 1e-3 * std::numbers::sqrt2 * std::cos(std::numbers::pi / 32);
  EXPECT_NEAR(rounded.faces[0].deviation_mm.hi, askew_mm, 1e-12);
  EXPECT_EQ(rounded.faces[0].deviation_mm.lo, -rounded.faces[0].deviation_mm.hi);
}

/// A block of small triangles of which one on top, at (x, y) near the middle, is missing.
SolidPtr cracked_block() {
  TriangleMesh mesh = box({10, 10, 10}, Vec3::Zero(), 40);
  std::uint32_t top = 0;
  double nearest = 1e9;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    if (const double off = (middle - Vec3(0, 0, 10)).norm(); off < nearest) {
      nearest = off;
      top = t;
    }
  }
  mesh.triangles.erase(mesh.triangles.begin() + top);
  return solid(mesh);
}

CollisionClass class_beside_cracks(const OverlapResult& result) {
  CollisionClass worst = CollisionClass::kNone;
  for (const OverlapRegion& region : result.regions)
    worst = std::max(worst, class_of(region, result.no_inside || region.at_crack));
  return worst;
}

TEST(Crack, FarFromItTheDepthIsKnown) {
  const OverlapCase c{cracked_block(), solid(box({1, 1, 1}, {8, 0, 10.5}))};
  const OverlapResult result = overlap_of(c);
  EXPECT_FALSE(result.no_inside);
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_NEAR(result.regions[0].delta_mm.lo, 0.5, 1e-3);
  EXPECT_EQ(class_beside_cracks(result), CollisionClass::kReal);
}

TEST(Crack, InItNothingIsKnown) {
  // Pins so thin that they pass the hole without meeting a triangle: one ends in it.
  const SolidPtr block = cracked_block();
  const auto pin = [&](double to_z) { return solid(box({0.01, 0.01, 2}, {0.1, 0.2, to_z + 2.0})); };
  const OverlapCase tip{block, pin(9.8)}, deep{block, pin(6)}, clear{block, pin(12)};
  for (const OverlapCase& c : {tip, OverlapCase{tip.b, tip.a}})
    EXPECT_EQ(class_beside_cracks(overlap_of(c)), CollisionClass::kPotential);
  EXPECT_EQ(class_beside_cracks(overlap_of(deep)),
            CollisionClass::kReal);  // beyond it all is known
  EXPECT_TRUE(overlap_of(clear).regions.empty());
}

TEST(Contained, TheMiddleIsDeeperThanTheSurface) {
  // Two cubes that share an edge; in the middle of one a pin of 2: 10 and 1.
  TriangleMesh cubes = together(box({10, 10, 10}), box({10, 10, 10}, {20, 20, 0}));
  const OverlapCase c{solid(cubes), solid(box({1, 1, 1}))};
  const OverlapResult result = overlap_of(c);
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_NEAR(result.regions[0].delta_mm.lo, 11.0, 1e-9);
  EXPECT_GE(result.regions[0].delta_mm.hi, 11.0);
  EXPECT_LE(result.regions[0].delta_mm.hi, 11.06);
  EXPECT_EQ(worst_class(result), CollisionClass::kReal);
}

}  // namespace
}  // namespace mortise
