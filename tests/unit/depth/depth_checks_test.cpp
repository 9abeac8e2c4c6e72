// What the stages of a depth promise each other is checked: a planted fault ends the program.
#include <gtest/gtest.h>

#include <cmath>

#include "common/depth/cells/cover.h"
#include "common/depth/cells/cover_pair.h"
#include "common/depth/cells/decide.h"
#include "common/depth/cells/linear_program.h"
#include "common/depth/gpd/holds.h"
#include "common/depth/gpd/hull_depth.h"
#include "common/depth/gpd/inner_piece.h"
#include "common/depth/gpd/separation_search.h"
#include "common/depth/search/search.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

const double kNoNumber = std::nan("");

SolidPtr plate_with_bore() {
  return shapes::solid(shapes::ring({10.0, 0.0, 20.0, 32, 1, 0.0}, 20.0));
}

TEST(DepthChecks, ACoverHasUnitDirections) {
  const SolidPtr plate = plate_with_bore();
  SurfaceBand band = shapes::cylinder_band(plate, 10.0, true, {0.0, 0.021});
  ASSERT_FALSE(find_cover(Body(*plate, band)).least.voids.empty());
  for (SurfaceBand::Face& face : band.faces)
    if (face.surface) face.surface->axis *= 1.0 + 1e-9;
  EXPECT_DEATH(find_cover(Body(*plate, band)), "has a unit normal");
}

TEST(DepthChecks, TheLeastBodiesLieWithinTheLargest) {
  const SolidPtr cube = shapes::solid(shapes::box({5.0, 5.0, 5.0}));
  const SurfaceBand band = shapes::uniform_band({}, {-0.1, 0.1}, DeviationGrade::kPlanar);
  PlaneFaces planes = find_plane_faces(*cube, band);
  ASSERT_EQ(planes.faces.size(), 6u);
  SharpQuery query;
  query.a = query.b = {cube.get(), &planes};
  query.X_BA = Pose::translation({9.9, 0.3, 0.2});
  query.depth_mm = 1.0;
  ASSERT_EQ(decide(query).state, SharpDecision::State::kDecided);
  for (PlaneFace& face : planes.faces) std::swap(face.offset_mm.lo, face.offset_mm.hi);
  EXPECT_DEATH(decide(query), "the least bodies lie within the largest");
  query.depth_mm = kNoNumber;
  EXPECT_DEATH(decide(query), "a depth must be a length");
}

TEST(DepthChecks, WhatIsAskedOfCoversIsANumber) {
  const CoverLayer nothing;
  const CoverPair pair(nothing, nothing);
  std::uint64_t work = 0;
  EXPECT_DEATH(pair.overlap(Pose(), kNoNumber, work), "what counts as least is a number");
  EXPECT_DEATH(pair.overlap(Pose{Quat(2.0, 0.0, 0.0, 0.0), Vec3::Zero()}, 0.0, work),
               "its quaternion unit");
}

TEST(DepthChecks, VariablesHaveBounds) {
  using Vector = LinearProgram::Vector;
  EXPECT_DEATH(LinearProgram(2, Vector{0.0, 1.0}, Vector{1.0, 0.0}, Vector{1.0, 0.0}),
               "the lower one first");
  EXPECT_DEATH(LinearProgram(1, Vector{0.0}, Vector{INFINITY}, Vector{1.0}), "finite bounds");
  EXPECT_DEATH(LinearProgram(6, Vector{}, Vector{}, Vector{}), "some variables");
}

TEST(DepthChecks, AHullDepthIsOfBodiesThatAreThere) {
  gpd::ConvexBody body{[](const Vec3&) { return Vec3(Vec3::Zero()); }, Vec3::Zero(), 1.0, 1.0};
  gpd::ConvexBody nowhere = body;
  nowhere.middle_W.x() = kNoNumber;
  EXPECT_DEATH(gpd::hull_depth(body, nowhere, 1e-3), "has a middle and a radius");
  EXPECT_DEATH(gpd::hull_depth(body, body, -1.0), "an accuracy must be a length");
}

TEST(DepthChecks, ALowerBoundDoesNotPassWhatPartsThem) {
  const SolidPtr cube = shapes::solid(shapes::box({5.0, 5.0, 5.0}));
  CcdScratch scratch;
  std::uint64_t work = 0;
  gpd::HoldsQuery query;
  query.a = query.b = cube.get();
  query.known_mm = 2.0;
  query.limit_mm = 1.0;
  EXPECT_DEATH(gpd::held_by_balls(query, scratch, work), "no more than what parts them");
  query.known_mm = kNoNumber;
  EXPECT_DEATH(gpd::held_by_balls(query, scratch, work), "no more than what parts them");
}

TEST(DepthChecks, ASeparationIsSoughtOfTwoSolidsAtPoses) {
  const SolidPtr cube = shapes::solid(shapes::box({5.0, 5.0, 5.0}));
  CcdScratch scratch;
  gpd::SeparationQuery query;
  EXPECT_DEATH(gpd::find_separation(query, scratch), "two solids");
  query.a = query.b = cube.get();
  query.X_WA.p.z() = kNoNumber;
  EXPECT_DEATH(gpd::find_separation(query, scratch), "poses must be finite");
}

TEST(DepthChecks, ASearchHasRegionsForItsRoots) {
  const SolidPtr plate = plate_with_bore();
  const SurfaceBand band = nominal_band();
  OverlapQuery of;
  of.a = of.b = plate.get();
  of.band_a = of.band_b = &band;
  const PairFrame pair(of);
  const std::vector<Root> roots = {{0, 0, 1}};
  SearchQuery query;
  query.pair = &pair;
  query.roots = &roots;
  query.regions = 1;
  SearchScratch scratch;
  std::uint64_t evaluations = 0;
  EXPECT_DEATH(search_depth(query, scratch, evaluations), "of a region");
}

}  // namespace
}  // namespace mortise
