// The oracles of the benchmark: themselves held against known values, and a short run of each.
#include "tests/bench/judgement_oracle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/signed_distance.h"
#include "tests/bench/judgement_convex.h"
#include "tests/bench/judgement_csg_cases.h"

namespace mortise::bench {
namespace {

std::vector<HalfSpace> cube(double half_mm, const Vec3& middle) {
  std::vector<HalfSpace> faces;
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 n = side * Vec3::Unit(k);
      faces.push_back({n, half_mm + n.dot(middle)});
    }
  return faces;
}

TEST(JudgementOracle, ProgramsKnowCubes) {
  const auto a = cube(1.0, Vec3(0, 0, 0)), b = cube(1.0, Vec3(1.9, 0.3, 0.2));
  EXPECT_NEAR(inner_margin_mm(a, b).lo, 0.05, 1e-15);
  EXPECT_LT(inner_margin_mm(a, b).width(), 1e-15);
  EXPECT_NEAR(overlap_depth_mm(a, b)->middle(), 0.1, 1e-15);
  EXPECT_NEAR(inner_margin_mm(a, cube(1.0, Vec3(2.5, 0, 0))).hi, -0.25, 1e-15);
  EXPECT_FALSE(overlap_depth_mm(a, cube(1.0, Vec3(2.5, 0, 0))).has_value());
  EXPECT_NEAR(shift_to_margin_mm(b, a, Vec3::UnitX(), 0.01), 0.08, 1e-14);
}

TEST(JudgementOracle, HullsHaveTheirFaces) {
  const ConvexPart box = convex_hull({{-1, -1, -1},
                                      {1, -1, -1},
                                      {1, 1, -1},
                                      {-1, 1, -1},
                                      {-1, -1, 1},
                                      {1, -1, 1},
                                      {1, 1, 1},
                                      {-1, 1, 1}});
  ASSERT_EQ(box.faces.size(), 6u);
  for (const ConvexPart::Face& face : box.faces) EXPECT_EQ(face.corners.size(), 4u);
  EXPECT_NEAR(worst_travel(box), std::sqrt(3.0), 1e-12);
}

TEST(JudgementOracle, AFalseWordIsSeen) {
  OracleTruth apart{-1e-3, -5e-4, false, {}, {}, {}}, deep{1e-3, 2e-3, false, {}, {}, {}};
  Word real, none;
  real.collision_class = CollisionClass::kReal;
  real.witness_W = Vec3::Zero();
  EXPECT_EQ(faults_of(apart, real, 1.0), std::vector{Fault::kFalseReal});
  EXPECT_EQ(faults_of(deep, real, -1e-3), std::vector{Fault::kWitnessOutside});
  EXPECT_EQ(faults_of(deep, real, std::nullopt), std::vector{Fault::kNoWitness});
  EXPECT_EQ(faults_of(deep, none, std::nullopt), std::vector{Fault::kFalseNone});
  EXPECT_TRUE(faults_of(apart, none, std::nullopt).empty());
  EXPECT_TRUE(faults_of(deep, real, 1e-3).empty());
}

// The optimum of the sum is reached at a point: the vertex that both brackets meet in.
TEST(JudgementOracle, OverlapsAreBetweenTheirBounds) {
  int deep = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OracleTruth truth = draw_convex(seed).truth;
    EXPECT_LE(truth.certain_mm, truth.possible_mm + 1e-9);
    if (!truth.possible_depth_mm) continue;
    ++deep;
    EXPECT_GE(*truth.possible_depth_mm, truth.possible_mm - 1e-9) << seed;
  }
  EXPECT_GT(deep, 20);
}

// What the membership says of a point off the surface, the mesh says as well.
TEST(JudgementOracle, CsgMembershipIsThatOfTheMesh) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    Dice dice(seed);
    const double kind = dice.between(0.0, 1.0);
    const CsgPart part = (kind < 0.5   ? draw_plate(dice, 10.0, kind < 0.2 ? 2.0 : 0.0)
                          : kind < 0.9 ? draw_shaft(dice, 10.0, 0.0)
                                       : draw_torus(dice, 10.0))
                             .part;
    const Solid solid(part.mesh);
    EXPECT_TRUE(solid.topology().closed()) << part.text;
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
      for (const std::uint32_t p : part.mesh.triangles[t])
        EXPECT_NEAR(part.faces[part.face_of_triangle[t]].height_mm(part.mesh.points_mm[p]), 0.0,
                    1e-12)
            << part.text;
    for (int i = 0; i < 200; ++i) {
      const Vec3 x(dice.between(-12, 24), dice.between(-12, 12), dice.between(-4, 24));
      const double distance = signed_distance_mm(solid, x);
      if (std::abs(distance) < 0.4) continue;  // more than the chords of 12 facets
      EXPECT_EQ(distance<0.0, part.depth_mm(x, CsgLayer::kModelled)> 0.0)
          << part.text << " seed " << seed << ", distance " << distance;
    }
  }
}

TEST(JudgementOracle, TheDeepestPointOfTwoBallsIsFound) {
  Dice dice(5);
  const CsgPart a = draw_ball(dice, 10.0).part, b = draw_ball(dice, 10.0).part;
  const double both = a.faces[0].radius + b.faces[0].radius;
  for (const double apart : {-0.01, 0.02, 1.0}) {
    const CsgPair pair{&a, &b, Pose::translation((both + apart) * dice.direction())};
    EXPECT_NEAR(2.0 * deepest_point(pair, CsgLayer::kModelled, 5).depth_mm, -apart, 1e-7);
  }
}

TEST(JudgementOracle, ConvexPairsAreJudgedRight) {
  OracleRun run;
  for (std::uint64_t seed = 0; seed < 120; ++seed)
    run.add(draw_convex(seed), {"convex", seed % 2 == 1, false, seed % 50 == 0});
  run.finish();
  EXPECT_EQ(run.crashes(), 0);
  EXPECT_EQ(run.contradictions(), 0);
  EXPECT_EQ(run.class_changes(), 0);
  EXPECT_GE(run.score("convex").found_percent(), 97.0);
}

// Corners that travel farther than the inner overlap and the offsets of the faces together.
TEST(JudgementOracle, TipsDeeperThanTheInnerOverlapHaveABracket) {
  for (const std::uint64_t seed : {3600u, 5580u, 17501u}) {
    OracleRun run;
    run.add(draw_convex(seed), {"convex", false, true, true});
    run.finish();
    EXPECT_EQ(run.crashes(), 0) << seed;
    EXPECT_EQ(run.contradictions(), 0) << seed;
  }
}

// Overlaps that grow away from the surface, tips that travel far, a chamfer beside a face that
// keeps apart: a bracket left out the truth.
TEST(JudgementOracle, NumbersOfHardPairsAreInTheirBrackets) {
  OracleRun run;
  for (const std::uint64_t seed : {55u, 2170u, 4884u, 40511u, 60843u, 94188u})
    run.add(draw_convex(seed), {"convex", false, true, true});
  for (const std::uint64_t seed : {991u, 40020u})
    run.add(draw_csg(seed).asked(seed, false), {"csg", false, true, true});
  run.finish();
  EXPECT_EQ(run.crashes(), 0);
  EXPECT_EQ(run.contradictions(), 0);
  EXPECT_EQ(run.class_changes(), 0);
  for (const char* way : {"convex", "convex, full", "csg", "csg, full"})
    EXPECT_EQ(run.score(way).false_numbers(), 0) << way;
}

TEST(JudgementOracle, CsgPairsAreJudgedRight) {
  OracleRun run;
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    run.add(draw_csg(seed).asked(seed, false), {"csg", seed % 2 == 1});
  run.finish();
  EXPECT_EQ(run.contradictions(), 0);
  EXPECT_GE(run.score("csg").found_percent(), 80.0);
}

}  // namespace
}  // namespace mortise::bench
