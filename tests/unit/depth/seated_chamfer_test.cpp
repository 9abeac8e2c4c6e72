// A chamfered part that stands on a face touches it, whatever is known of its chamfer.
#include <gtest/gtest.h>

#include "common/geometry/recognition/recognition.h"
#include "tests/support/lofted.h"
#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr double kRadius_mm = 10.0, kChamfer_mm = 1.0, kLength_mm = 15.0;

struct Disc {
  SolidPtr solid;
  Surface chamfer, wall;
};

// A chamfer at `degrees` to the flat end, whose triangles have all corners on the chamfer's rim.
Disc disc_of(double degrees, int facets) {
  const double radians = degrees * std::numbers::pi / 180.0;
  const double out_mm = kChamfer_mm * std::cos(radians), up_mm = kChamfer_mm * std::sin(radians);
  const double rim_mm = kRadius_mm - out_mm;
  Disc disc;
  disc.solid = std::make_shared<const Solid>(lofted(
      {ellipse(rim_mm, rim_mm, facets), at_height(ellipse(kRadius_mm, kRadius_mm, facets), up_mm),
       at_height(ellipse(kRadius_mm, kRadius_mm, facets), kLength_mm)}));
  disc.chamfer.kind = SurfaceKind::kCone;
  disc.chamfer.half_angle_rad = 0.5 * std::numbers::pi - radians;
  disc.chamfer.point = Vec3(0, 0, -rim_mm * std::tan(radians));
  disc.wall.kind = SurfaceKind::kCylinder;
  disc.wall.radius_mm = kRadius_mm;
  return disc;
}

// Triangles whose middle is between two heights, the ends of the part left out.
std::vector<std::uint32_t> between(const TriangleMesh& mesh, double lo_mm, double hi_mm) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const double z = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)).z() / 3.0;
    if (z > lo_mm + 1e-6 && z < hi_mm - 1e-6) found.push_back(t);
  }
  return found;
}

enum class Known { kDeclared, kExact, kRecognized };

SurfaceBand band_of(const Disc& disc, Known known, double quantum_mm = 0.0) {
  BandInput input;
  input.solid = disc.solid.get();
  input.quantum_mm = quantum_mm;
  std::vector<Feature> features;
  if (known == Known::kRecognized) {
    features = recognize_features(*disc.solid).features;
    input.estimate = true;
  } else {
    const double up_mm =
        disc.chamfer.point.z() + kRadius_mm / std::tan(disc.chamfer.half_angle_rad);
    for (const auto& [surface, lo_mm, hi_mm] :
         {std::tuple(disc.chamfer, 0.0, up_mm), std::tuple(disc.wall, up_mm, kLength_mm)}) {
      const FeatureDeclaration declared{"face", surface, std::nullopt, 0.0};
      const auto match =
          known == Known::kDeclared
              ? match_feature(disc.solid->mesh(), declared)
              : check_feature(*disc.solid, declared, between(disc.solid->mesh(), lo_mm, hi_mm));
      EXPECT_TRUE(match);
      if (match) features.push_back(match->feature);
    }
  }
  input.features = features;
  input.of_feature.resize(features.size());
  return build_band(input);
}

class SeatedChamfer : public testing::TestWithParam<Known> {};

TEST_P(SeatedChamfer, TouchesTheFaceItStandsOn) {
  const auto plate = std::make_shared<const Solid>(box(Vec3(30, 30, 5), Vec3(0, 0, -5)));
  for (const double degrees : {5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 80.0})
    for (const int facets : {12, 16, 31, 64, 96})
      for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
        const Disc disc = disc_of(degrees, facets);
        OverlapCase c{plate, disc.solid};
        c.band_b = band_of(disc, GetParam());
        c.X_WB = Pose{rotation_exp(Vec3(0, 0, 0.7)), Vec3(3, -2, 0)};
        c.refinement = refinement;
        EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kNone)
            << degrees << " degrees, " << facets << " facets, refinement "
            << static_cast<int>(refinement);
      }
}

// Files are rounded by more than what counts as touching.
TEST_P(SeatedChamfer, TouchesItHoweverCoarseTheFilesAre) {
  constexpr double kQuantum_mm = 5e-6;
  const auto plate = std::make_shared<const Solid>(box(Vec3(30, 30, 5), Vec3(0, 0, -5)));
  BandInput of_plate;
  of_plate.solid = plate.get();
  of_plate.quantum_mm = kQuantum_mm;
  for (const double degrees : {10.0, 45.0, 80.0})
    for (const int facets : {16, 31})
      for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
        const Disc disc = disc_of(degrees, facets);
        OverlapCase c{plate, disc.solid};
        c.band_a = build_band(of_plate);
        c.band_b = band_of(disc, GetParam(), kQuantum_mm);
        c.X_WB = Pose{rotation_exp(Vec3(0, 0, 0.7)), Vec3(3, -2, 0)};
        c.refinement = refinement;
        EXPECT_TRUE(overlap_of(c).regions.empty()) << degrees << " degrees, " << facets;
        // More than both files are rounded by is told.
        c.X_WB.p.z() = -3.0 * kQuantum_mm;
        EXPECT_GE(worst_class(overlap_of(c)), CollisionClass::kPotential) << degrees;
      }
}

// A declared journal that may be 4 um larger than its bore: no rounding, however coarse the files
// are.
TEST(DeclaredFaces, AreNotLeftOutForTheRoundingOfTheirFiles) {
  constexpr double kRadius = 10.0, kQuantum_mm = 5e-6, kMore_mm = 4e-6;
  OverlapCase c;
  const auto band_of_round = [&](const SolidPtr& solid, bool inward, double more_mm) {
    Surface surface;
    surface.kind = SurfaceKind::kCylinder;
    surface.radius_mm = kRadius;
    surface.inward = inward;
    const auto match = match_feature(solid->mesh(), {"round", surface, std::nullopt, 0.0});
    EXPECT_TRUE(match);
    const std::vector<Feature> features = {match->feature};
    BandInput input;
    input.solid = solid.get();
    input.quantum_mm = kQuantum_mm;
    input.features = features;
    input.of_feature.resize(1);
    input.of_feature[0].offset_mm = {0.0, more_mm};
    return build_band(input);
  };
  c.a = solid(peg({kRadius, -5, 25, 48}));
  c.b = solid(ring({kRadius, 0, 20, 48}, 20));
  c.band_a = band_of_round(c.a, false, kMore_mm);
  c.band_b = band_of_round(c.b, true, 0.0);
  EXPECT_GE(worst_class(overlap_of(c)), CollisionClass::kPotential);
}

INSTANTIATE_TEST_SUITE_P(Grades, SeatedChamfer,
                         testing::Values(Known::kDeclared, Known::kExact, Known::kRecognized));

// The flat end is 0.1 mm short of its model, and with it ends the chamfer: nothing of the part is
// left below, however flat the chamfer is.
TEST(MovedEnd, CutsItsChamferShort) {
  const auto plate = std::make_shared<const Solid>(box(Vec3(30, 30, 5), Vec3(0, 0, -5)));
  constexpr double kShort_mm = 0.1;
  for (const double degrees : {5.0, 10.0, 30.0, 45.0, 80.0})
    for (const double sunk_mm : {0.5, 0.8, 0.95, 1.05, 1.5, 3.0})
      for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
        const Disc disc = disc_of(degrees, 48);
        OverlapCase c{plate, disc.solid};
        c.band_b = band_of(disc, Known::kDeclared);
        c.band_b.faces[0].tolerance_mm = {-kShort_mm, -kShort_mm};
        c.band_b.largest_offset_mm = std::max(c.band_b.largest_offset_mm, kShort_mm);
        c.band_b.trivial = false;
        c.X_WB = Pose{rotation_exp(Vec3(0, 0, 0.7)), Vec3(3, -2, -sunk_mm * kShort_mm)};
        c.refinement = refinement;
        const CollisionClass said = worst_class(overlap_of(c));
        SCOPED_TRACE(testing::Message() << degrees << " degrees, sunk " << sunk_mm << " of 0.1 mm");
        if (sunk_mm < 1.0)
          EXPECT_NE(said, CollisionClass::kReal);
        else
          EXPECT_EQ(said, CollisionClass::kReal);
      }
}

// No part of the flat end is a part of the chamfer.
TEST(FlatEnd, IsNotOfTheChamferThatEndsThere) {
  for (const double degrees : {5.0, 10.0, 15.0, 20.0})
    for (const int facets : {12, 40, 96}) {
      const Disc disc = disc_of(degrees, facets);
      const TriangleMesh& mesh = disc.solid->mesh();
      const auto at_end = [&](std::uint32_t t) {
        return mesh.corner(t, 0).z() == 0.0 && mesh.corner(t, 1).z() == 0.0 &&
               mesh.corner(t, 2).z() == 0.0;
      };
      std::vector<Feature> found = recognize_features(*disc.solid).features;
      const auto match = match_feature(mesh, {"chamfer", disc.chamfer, std::nullopt, 0.0});
      ASSERT_TRUE(match);
      found.push_back(match->feature);
      for (const Feature& feature : found)
        if (feature.surface.kind == SurfaceKind::kCone) {
          for (const std::uint32_t t : feature.triangles)
            EXPECT_FALSE(at_end(t)) << feature.name << ", " << degrees << " degrees, " << facets;
        }
    }
}

}  // namespace
}  // namespace mortise
