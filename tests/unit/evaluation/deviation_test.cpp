#include "common/evaluation/deviation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/evaluation/band.h"
#include "common/math/rotation.h"
#include "tests/unit/evaluation/fit_faces.h"
#include "tests/unit/evaluation/shapes.h"

namespace mortise {
namespace {

FeatureDeclaration declared(const std::string& name, const Surface& surface) {
  FeatureDeclaration d;
  d.name = name;
  d.surface = surface;
  return d;
}

void expect_refused(const Result<FeatureMatch>& match, const std::string& says) {
  ASSERT_FALSE(match);
  EXPECT_NE(match.error().text.find(says), std::string::npos) << match.error().text;
}

TEST(Deviation, FindsTheWallAndNotTheCaps) {
  const TriangleMesh tube = shapes::turned(10.0, 6.0, 20.0, 32);
  const auto outer = match_feature(tube, declared("outer", cylinder(10.0, false)));
  const auto bore = match_feature(tube, declared("bore", cylinder(6.0, true)));
  ASSERT_TRUE(outer);
  ASSERT_TRUE(bore);
  EXPECT_EQ(outer->feature.triangles.size(), 64U);
  EXPECT_EQ(bore->feature.triangles.size(), 64U);
  EXPECT_LT(bore->feature.residual_mm, 1e-12);
  EXPECT_TRUE(bore->note.empty());
  EXPECT_EQ(bore->feature.grade, DeviationGrade::kDeclaredFeature);
  const TriangleMesh rod = shapes::turned(10.0, 0.0, 20.0, 6);  // the caps' corners are all on it
  const auto wall = match_feature(rod, declared("wall", cylinder(10.0, false)));
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->feature.triangles.size(), 12U);
}

TEST(Deviation, TheCapAtTheEndOfAChamferIsNotTheChamfer) {
  // A frustum of 45 degrees: the corners of its caps lie on the cone too.
  TriangleMesh mesh = shapes::turned(10.0, 0.0, 2.0, 32);
  for (Vec3& p : mesh.points_mm)
    if (p.z() > 1.0) p.head<2>() *= 0.8;
  Surface cone;
  cone.kind = SurfaceKind::kCone;
  cone.point = Vec3(0, 0, 10);
  cone.axis = -Vec3::UnitZ();
  cone.half_angle_rad = std::numbers::pi / 4;
  const auto match = match_feature(mesh, declared("chamfer", cone));
  ASSERT_TRUE(match) << match.error().text;
  EXPECT_EQ(match->feature.triangles.size(), 64U);
  EXPECT_EQ(match->note, "");
}

TEST(Deviation, RealTessellationsAreOffByMicrometresAndAreCarried) {
  TriangleMesh tube = shapes::turned(10.0, 4.05, 9.0, 48);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.6e-3, 0.6e-3);
  for (Vec3& p : tube.points_mm) {
    const double r = std::hypot(p.x(), p.y());
    if (r > 5.0) continue;
    const double factor = (r + off(random)) / r;
    p.x() *= factor, p.y() *= factor;
  }
  const auto bore = match_feature(tube, declared("bore", cylinder(4.05, true)));
  ASSERT_TRUE(bore);
  EXPECT_EQ(bore->feature.triangles.size(), 96U);
  EXPECT_GT(bore->feature.residual_mm, 0.3e-3);
  EXPECT_LT(bore->feature.residual_mm, 0.6e-3 + 1e-9);
}

TEST(Deviation, TrianglesThatJustMissAreSaid) {
  TriangleMesh tube = shapes::turned(10.0, 5.0, 9.0, 48);
  for (Vec3& p : tube.points_mm)
    if (std::hypot(p.x(), p.y()) < 6.0 && p.x() > 4.999) p.x() -= 2e-3;
  const auto bore = match_feature(tube, declared("bore", cylinder(5.0, true)));
  ASSERT_TRUE(bore);
  EXPECT_EQ(bore->feature.triangles.size(), 92U);
  EXPECT_NE(bore->note.find("4 more triangles"), std::string::npos) << bore->note;
  FeatureDeclaration generous = declared("bore", cylinder(5.0, true));
  generous.chord_error_mm = 2.1e-3;
  const auto all = match_feature(tube, generous);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->feature.triangles.size(), 96U);
  EXPECT_NEAR(all->feature.residual_mm, 2e-3, 1e-9);
}

TEST(Deviation, AWrongRadiusIsRefusedWithTheOneTheMeshHas) {
  const TriangleMesh tube = shapes::turned(12.0, 8.1, 20.0, 64);
  expect_refused(match_feature(tube, declared("bore", cylinder(8.0, true))),
                 "the mesh has radius 8.1 mm");
  const TriangleMesh rod = shapes::turned(8.1, 0.0, 20.0, 64);
  expect_refused(match_feature(rod, declared("rod", cylinder(8.0, false))),
                 "the mesh has radius 8.1 mm");
  // A generous chord error does not hide it: the facets would have to reach the surface.
  FeatureDeclaration loose = declared("bore", cylinder(8.0, true));
  loose.chord_error_mm = 0.15;
  expect_refused(match_feature(tube, loose), "the mesh has radius 8.1 mm");
}

TEST(Deviation, WrongSideWrongAxisWrongExtentAreToldApart) {
  const TriangleMesh tube = shapes::turned(12.0, 8.0, 20.0, 64);
  expect_refused(match_feature(tube, declared("bore", cylinder(8.0, false))), "inward: true");
  expect_refused(match_feature(tube, declared("outer", cylinder(12.0, true))), "inward: false");
  Surface sideways = cylinder(8.0, true);
  sideways.axis = Vec3::UnitX();
  sideways.point = Vec3(0, 0, 500);
  expect_refused(match_feature(tube, declared("bore", sideways)), "check point, axis and unit");
  FeatureDeclaration beyond = declared("bore", cylinder(8.0, true));
  beyond.along_mm = Interval{30.0, 40.0};
  EXPECT_FALSE(match_feature(tube, beyond));
  beyond.along_mm = Interval{0.0, 20.0};
  EXPECT_TRUE(match_feature(tube, beyond));
}

TEST(Deviation, MovedFarAwayItIsTheSame) {
  const Pose X{rotation_exp(Vec3(0.3, -1.0, 2.0)), Vec3(3e4, -2e4, 1e4)};
  const TriangleMesh tube = transformed(shapes::turned(10.0, 6.0, 20.0, 32), X);
  Surface bore = cylinder(6.0, true);
  bore.point = X.p;
  bore.axis = X.q * Vec3::UnitZ();
  const auto match = match_feature(tube, declared("bore", bore));
  ASSERT_TRUE(match);
  EXPECT_EQ(match->feature.triangles.size(), 64U);
  EXPECT_LT(match->feature.residual_mm, 1e-10);
}

TEST(Deviation, AFlatCutWithItsCornersOnTheRoundIsNotTheRound) {
  // A D shaft: of 64 corners, 16 facets are replaced by one flat.
  TriangleMesh mesh;
  std::vector<int> corners;
  for (int i = 0; i <= 48; ++i) corners.push_back(i);
  const auto n = static_cast<std::uint32_t>(corners.size());
  for (const double z : {0.0, 20.0})
    for (const int i : corners) {
      const double a = 2.0 * std::numbers::pi * i / 64;
      mesh.points_mm.emplace_back(10 * std::cos(a), 10 * std::sin(a), z);
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  const auto match = match_feature(mesh, declared("round", cylinder(10.0, false)));
  ASSERT_TRUE(match);
  EXPECT_EQ(match->feature.triangles.size(), 96U);
  EXPECT_NE(match->note.find("2 triangles"), std::string::npos) << match->note;
}

TEST(Deviation, PlanesMatchByPlaceAndSide) {
  const TriangleMesh block = shapes::block(20, 20, 10);
  Surface top;
  top.kind = SurfaceKind::kPlane;
  top.point = Vec3(0, 0, 5);
  const auto match = match_feature(block, declared("top", top));
  ASSERT_TRUE(match);
  EXPECT_EQ(match->feature.triangles.size(), 2U);
  EXPECT_EQ(match->feature.grade, DeviationGrade::kPlanar);
  top.axis = -Vec3::UnitZ();
  expect_refused(match_feature(block, declared("top", top)), "other side");
  top.axis = Vec3::UnitZ();
  top.point = Vec3(0, 0, 4.9);
  expect_refused(match_feature(block, declared("top", top)), "stands off by 0.1 mm");
}

TEST(Deviation, ShapesUnderAChordError) {
  const Solid tube(shapes::turned(10.0, 6.0, 20.0, 32));
  const auto shapes_of = face_shapes(tube, 0.05);
  std::array<int, 6> count{};
  for (const FaceShape s : shapes_of) ++count[static_cast<std::size_t>(s)];
  EXPECT_EQ(count[static_cast<std::size_t>(FaceShape::kConvex)], 64);
  EXPECT_EQ(count[static_cast<std::size_t>(FaceShape::kConcave)], 64);
  EXPECT_EQ(count[static_cast<std::size_t>(FaceShape::kPlanar)], 128);
  // Facets of 60 degrees are no edges when the declared error is as large as their sagitta, and are
  // edges when it is far smaller.
  const Solid six(shapes::turned(10.0, 0.0, 20.0, 6));
  const double sagitta_mm = 10.0 * (1.0 - std::cos(std::numbers::pi / 6));
  EXPECT_EQ(face_shapes(six, 1.01 * sagitta_mm)[0], FaceShape::kConvex);
  EXPECT_EQ(face_shapes(six, 0.1 * sagitta_mm)[0], FaceShape::kPlanar);
  EXPECT_EQ(chord_deviation_mm(FaceShape::kConvex, 0.1), (Interval{0.0, 0.1}));
  EXPECT_EQ(chord_deviation_mm(FaceShape::kConcave, 0.1), (Interval{-0.1, 0.0}));
  EXPECT_EQ(chord_deviation_mm(FaceShape::kPlanar, 0.1), (Interval{0.0, 0.0}));
  EXPECT_EQ(chord_deviation_mm(FaceShape::kUnknown, 0.1), (Interval{-0.1, 0.1}));
}

TEST(Band, NothingDeclaredSaysNothing) {
  const Solid tube(shapes::turned(10.0, 6.0, 20.0, 32));
  BandInput input;
  input.solid = &tube;
  const SurfaceBand band = build_band(input);
  EXPECT_TRUE(band.trivial);
  EXPECT_EQ(band.largest_offset_mm, 0.0);
  EXPECT_EQ(band.offset_mm(0, Vec3(10, 0, 0)), (Interval{0.0, 0.0}));
  EXPECT_EQ(tube.derived_bytes(), 0U);  // no tree, no topology was built for it
}

TEST(Band, AFeatureGivesTheExactOffsetAndTheLargestOne) {
  const Solid tube(shapes::turned(10.0, 6.0, 20.0, 32));
  const std::vector<Feature> features{
      match_feature(tube.mesh(), declared("outer", cylinder(10.0, false)))->feature,
      match_feature(tube.mesh(), declared("bore", cylinder(6.0, true)))->feature};
  BandInput input;
  input.solid = &tube;
  input.features = features;
  input.of_feature.resize(2);
  const SurfaceBand band = build_band(input);
  EXPECT_FALSE(band.trivial);
  EXPECT_NEAR(band.largest_offset_mm, 0.048152733,
              2e-7);  // the outer wall bulges, the bore recedes
  const std::uint32_t wall = features[0].triangles[0];
  const Vec3 middle = 0.5 * (tube.mesh().corner(wall, 0) + tube.mesh().corner(wall, 1));
  EXPECT_NEAR(band.offset_mm(wall, middle).lo, 0.048152733, 1e-8);
  EXPECT_NEAR(band.offset_mm(wall, tube.mesh().corner(wall, 0)).hi, 0.0, 1e-12);
  const std::uint32_t bore = features[1].triangles[0];
  const Vec3 inner = 0.5 * (tube.mesh().corner(bore, 0) + tube.mesh().corner(bore, 1));
  EXPECT_NEAR(band.offset_mm(bore, inner).hi, -6.0 * (1 - std::cos(std::numbers::pi / 32)), 1e-8);
}

TEST(Band, FeatureBeatsPartAndStatementsOfAPairBeatBoth) {
  const Solid tube(shapes::turned(10.0, 6.0, 20.0, 512));
  const std::vector<Feature> features{
      match_feature(tube.mesh(), declared("bore", cylinder(6.0, true)))->feature};
  BandInput input;
  input.solid = &tube;
  input.features = features;
  input.rest = {{-0.1, 0.1}, "±0.1 mm"};
  input.of_feature = {{{-0.02, 0.0}, "Ø12 H7"}};
  const SurfaceBand band = build_band(input);
  EXPECT_EQ(band.faces[0].tolerance_mm, (Interval{-0.1, 0.1}));
  EXPECT_EQ(band.faces[1].tolerance_mm, (Interval{-0.02, 0.0}));
  EXPECT_NEAR(band.largest_offset_mm, 0.1, 1e-12);
  const std::vector<FaceStatement> pair{{{-0.2, 0.3}, "pair"}};
  const SurfaceBand of_pair = with_statements(band, tube, input.rest, pair);
  EXPECT_EQ(of_pair.faces[1].tolerance_mm, (Interval{-0.2, 0.3}));
  EXPECT_EQ(of_pair.faces[1].tolerance_source, "pair");
  EXPECT_NEAR(of_pair.largest_offset_mm, 0.3, 1e-6);
}

TEST(Band, AChordErrorSplitsTheRestByShape) {
  const Solid tube(shapes::turned(10.0, 6.0, 20.0, 32));
  BandInput input;
  input.solid = &tube;
  input.chord_error_mm = 0.05;
  const SurfaceBand band = build_band(input);
  std::array<int, 4> seen{};
  for (std::uint32_t t = 0; t < tube.mesh().triangles.size(); ++t) {
    const Interval offset = band.offset_mm(t, tube.mesh().corner(t, 0));
    if (offset == Interval{0.0, 0.05}) ++seen[0];
    if (offset == Interval{-0.05, 0.0}) ++seen[1];
    if (offset == Interval{0.0, 0.0}) ++seen[2];
    if (offset == Interval{-0.05, 0.05}) ++seen[3];
  }
  EXPECT_EQ(seen, (std::array<int, 4>{64, 64, 128, 0}));
  EXPECT_DOUBLE_EQ(band.largest_offset_mm, 0.05);
}

}  // namespace
}  // namespace mortise
