#include "common/evaluation/roundness.h"

#include <gtest/gtest.h>

#include "common/evaluation/band.h"
#include "common/geometry/recognition/recognition.h"
#include "tests/support/lofted.h"

namespace mortise {
namespace {

using namespace shapes;

struct Known {
  SolidPtr solid;
  std::vector<Feature> features;

  const Feature* first(SurfaceKind kind) const {
    for (const Feature& f : features)
      if (f.surface.kind == kind) return &f;
    return nullptr;
  }
};

Known known_of(const std::vector<Vec3>& section) {
  Known known;
  known.solid = std::make_shared<const Solid>(lofted({section, at_height(section, 20.0)}));
  known.features = recognize_features(*known.solid).features;
  return known;
}

TEST(Roundness, OfAPrismOfUpTo64FlatsIsDoubtfulAndOfAFinerOneNot) {
  for (const int n : {11, 12, 24, 64, 65, 96}) {
    const Known known = known_of(ellipse(10.0, 10.0, n));
    const Feature* round = known.first(SurfaceKind::kCylinder);
    ASSERT_NE(round, nullptr) << n;
    const Roundness roundness = roundness_of(known.solid->mesh(), *round);
    EXPECT_TRUE(roundness.is_circle);
    EXPECT_EQ(roundness.doubtful.size(), n <= 64 ? round->triangles.size() : 0U) << n;
  }
}

TEST(Roundness, OfThreeFacetsOfAnEllipseIsNoCircle) {
  const Known known = known_of(ellipse(12.0, 9.0, 16, std::numbers::pi / 16));
  const Feature* round = known.first(SurfaceKind::kCylinder);
  ASSERT_NE(round, nullptr);
  const Roundness roundness = roundness_of(known.solid->mesh(), *round);
  EXPECT_FALSE(roundness.is_circle);
  EXPECT_EQ(roundness.doubtful, round->triangles);
}

TEST(Roundness, OfAFlatTwiceAsWideAsTheFacetsBesideItIsDoubtful) {
  std::vector<Vec3> section = ellipse(10.0, 10.0, 144);
  section.erase(section.begin() + 40);
  const Known known = known_of(section);
  const Feature* round = known.first(SurfaceKind::kCylinder);
  ASSERT_NE(round, nullptr);
  EXPECT_EQ(round->triangles.size(), 2U * 143U);
  EXPECT_EQ(roundness_of(known.solid->mesh(), *round).doubtful.size(), 2U);
}

TEST(Roundness, OfANamedFeatureIsDeclared) {
  const Known known = known_of(ellipse(10.0, 10.0, 16));
  Feature round = *known.first(SurfaceKind::kCylinder);
  round.origin = FeatureOrigin::kDeclared;
  EXPECT_TRUE(roundness_of(known.solid->mesh(), round).doubtful.empty());
}

// Flat and round are both within the band of a doubtful face.
TEST(Roundness, BandOfADoubtfulFaceHoldsPrismAndCylinder) {
  const Known known = known_of(ellipse(10.0, 10.0, 16));
  BandInput input;
  input.solid = known.solid.get();
  input.features = known.features;
  input.of_feature.assign(known.features.size(), {{-0.01, 0.02}, "size"});
  input.estimate = true;
  const SurfaceBand band = build_band(input);
  const Feature& round = *known.first(SurfaceKind::kCylinder);
  for (const std::uint32_t t : round.triangles) {
    const SurfaceBand::Face& face = band.face_of(t);
    EXPECT_EQ(face.name, round.name);
    EXPECT_EQ(face.grade, DeviationGrade::kEstimated);
    EXPECT_EQ(face.tolerance_source, "size");
    const TriangleMesh& mesh = known.solid->mesh();
    const Vec3 middle = 0.5 * (mesh.corner(t, 0) + mesh.corner(t, 1));
    const Interval offset = band.offset_mm(t, middle);
    const double sagitta_mm = -round.surface.signed_distance_mm(middle);
    EXPECT_LE(offset.lo, -0.01);
    EXPECT_GE(offset.hi, sagitta_mm + 0.02);
  }
}

}  // namespace
}  // namespace mortise
