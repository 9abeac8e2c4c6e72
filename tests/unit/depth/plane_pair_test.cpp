// Pairs of parts with plane faces and bands, as find_overlap judges them by their sharp bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "common/ccd/distance.h"
#include "common/depth/cells/sharp_window.h"
#include "common/evaluation/band.h"
#include "common/geometry/recognition/recognition.h"
#include "common/geometry/tips.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/support/lofted.h"
#include "tests/unit/depth/overlap_case.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

constexpr double kExact_mm = 1e-6;

SurfaceBand plus_minus(const SolidPtr& solid, double t_mm) {
  BandInput input;
  input.solid = solid.get();
  input.rest = {{-t_mm, t_mm}, "plus minus"};
  return build_band(input);
}

SolidPtr convex(const std::vector<polyhedra::HalfSpace>& half_spaces) {
  TriangleMesh mesh;
  std::vector<std::uint16_t> face_of;
  EXPECT_TRUE(polyhedra::mesh_of(half_spaces, mesh, face_of));
  return std::make_shared<const Solid>(std::move(mesh));
}

SolidPtr block(const Vec3& lo, const Vec3& hi) {
  std::vector<polyhedra::HalfSpace> six;
  for (int k = 0; k < 3; ++k) {
    six.push_back({Vec3::Unit(k), hi[k], {}});
    six.push_back({-Vec3::Unit(k), -lo[k], {}});
  }
  return convex(six);
}

/// A roof upside down: its edge is the line x = z = 0, 10 long; the angle between its faces.
SolidPtr wedge(double angle_rad) {
  const double c = std::cos(0.5 * angle_rad), s = std::sin(0.5 * angle_rad);
  return convex({{Vec3(c, 0, -s), 0.0, {}},
                 {Vec3(-c, 0, -s), 0.0, {}},
                 {Vec3(0, 0, 1), 8.0, {}},
                 {Vec3(0, 1, 0), 5.0, {}},
                 {Vec3(0, -1, 0), 5.0, {}}});
}

/// The wedge above a block, its edge at a height; both orders of the pair and both refinements say
/// the same class.
struct Above {
  OverlapCase c;
  Above(double angle_rad, double height_mm, double t_mm) {
    c.a = wedge(angle_rad);
    c.b = block({-20, -20, -10}, {20, 20, 0});
    c.band_a = plus_minus(c.a, t_mm);
    c.X_WA.p.z() = height_mm;
  }
};

CollisionClass agreed_class(OverlapCase c) {
  const CollisionClass full = worst_class(overlap_of(c));
  c.refinement = Refinement::kDecided;
  EXPECT_EQ(worst_class(overlap_of(c)), full);
  std::swap(c.a, c.b);
  std::swap(c.band_a, c.band_b);
  std::swap(c.X_WA, c.X_WB);
  EXPECT_EQ(worst_class(overlap_of(c)), full);
  return full;
}

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(PlanePair, AnEdgeMayReachFartherThanItsFaces) {
  // 0.05 / sin(45°) = 0.0707.
  EXPECT_EQ(agreed_class(Above(90 * kDegree, 0.06, 0.05).c), CollisionClass::kPotential);
  EXPECT_EQ(agreed_class(Above(90 * kDegree, 0.08, 0.05).c), CollisionClass::kNone);
  // 0.05 / sin(15°) = 0.1932.
  EXPECT_EQ(agreed_class(Above(30 * kDegree, 0.15, 0.05).c), CollisionClass::kPotential);
  EXPECT_EQ(agreed_class(Above(30 * kDegree, 0.19, 0.05).c), CollisionClass::kPotential);
  EXPECT_EQ(agreed_class(Above(30 * kDegree, 0.20, 0.05).c), CollisionClass::kNone);
  const OverlapResult edge = overlap_of(Above(30 * kDegree, 0.15, 0.05).c);
  ASSERT_EQ(edge.regions.size(), 1U);
  EXPECT_NEAR(edge.regions[0].delta_mm.lo, -0.15, kExact_mm);
  EXPECT_NEAR(edge.regions[0].possible_mm.hi, 0.05 / std::sin(15 * kDegree) - 0.15, kExact_mm);
  EXPECT_NEAR(edge.regions[0].certain_mm.lo, -0.05 / std::sin(15 * kDegree) - 0.15, kExact_mm);
}

TEST(PlanePair, AnEdgeIsCertainWhereItsLeastBodyReaches) {
  EXPECT_EQ(agreed_class(Above(30 * kDegree, -0.15, 0.05).c), CollisionClass::kPotential);
  EXPECT_EQ(agreed_class(Above(30 * kDegree, -0.25, 0.05).c), CollisionClass::kReal);
  for (const Refinement refinement : {Refinement::kFull, Refinement::kDecided}) {
    OverlapCase c = Above(30 * kDegree, -0.25, 0.05).c;
    c.refinement = refinement;
    const OverlapResult real = overlap_of(c);
    ASSERT_EQ(real.regions.size(), 1U);
    EXPECT_NEAR(real.regions[0].certain_mm.lo, 0.25 - 0.05 / std::sin(15 * kDegree), 1e-3);
    const Vec3& witness = real.regions[0].witness_W;
    EXPECT_LT(witness.z(), 0.0);
    EXPECT_GT(witness.z(), -0.25 + 0.05 / std::sin(15 * kDegree));
  }
}

TEST(PlanePair, ATipBeyondTheLimitIsNotFollowed) {
  // 0.05 / sin(2°) = 1.43 would be needed, twenty times 0.05 is followed.
  EXPECT_EQ(agreed_class(Above(4 * kDegree, 1.2, 0.05).c), CollisionClass::kNone);
  EXPECT_EQ(agreed_class(Above(10 * kDegree, 0.5, 0.05).c), CollisionClass::kPotential);
}

TEST(PlanePair, AWindowThatATipMayComeIntoFromOutsideIsNotUsed) {
  const SolidPtr knife = wedge(15 * kDegree);
  const SurfaceBand band = plus_minus(knife, 0.1);
  const PlaneFaces planes = find_plane_faces(*knife, band);
  // Half a millimetre before the edge: it may come to 0.1 / sin(7.5°) = 0.766.
  Box core;
  core.add(Vec3(0, 0, -0.5));
  EXPECT_EQ(SharpWindow(*knife, planes, core, 0.55, 0.0).state(), SharpWindow::State::kTooSharp);
  EXPECT_EQ(SharpWindow(*knife, planes, core, 0.78, 0.0).state(), SharpWindow::State::kReady);
}

// A tab in a slot, gap on both sides, all faces +-0.1: thresholds are -0.2 and 0.2 exactly.
OverlapCase tab_in_slot(double gap_mm) {
  OverlapCase c;
  TriangleMesh slot;
  const double w = 3.0;
  const std::vector<std::array<double, 2>> around = {{-10, -10}, {10, -10}, {10, 10}, {w, 10},
                                                     {w, -5},    {-w, -5},  {-w, 10}, {-10, 10}};
  for (const double z : {-4.0, 4.0})
    for (const auto& [x, y] : around) slot.points_mm.push_back({x, y, z});
  const auto n = static_cast<std::uint32_t>(around.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    slot.triangles.push_back({i, j, n + j});
    slot.triangles.push_back({i, n + j, n + i});
  }
  for (const std::array<std::uint32_t, 3>& t : {std::array<std::uint32_t, 3>{0, 1, 4},
                                                {0, 4, 5},
                                                {1, 2, 3},
                                                {1, 3, 4},
                                                {0, 5, 6},
                                                {0, 6, 7}}) {
    slot.triangles.push_back({n + t[0], n + t[1], n + t[2]});
    slot.triangles.push_back({t[0], t[2], t[1]});
  }
  c.a = std::make_shared<const Solid>(std::move(slot));
  EXPECT_TRUE(c.a->topology().closed());
  c.b = block({-w + gap_mm, -4, -3}, {w - gap_mm, 20, 3});
  c.band_a = plus_minus(c.a, 0.1);
  c.band_b = plus_minus(c.b, 0.1);
  return c;
}

TEST(PlanePair, FlatPartsHaveTheThresholdsOfTheirTolerances) {
  for (const double gap_mm : {0.025, 0.05, -0.03}) {
    OverlapCase c = tab_in_slot(gap_mm);
    c.refinement = gap_mm < 0.0 ? Refinement::kDecided : Refinement::kFull;
    const OverlapResult result = overlap_of(c);
    ASSERT_FALSE(result.regions.empty());
    EXPECT_EQ(worst_class(result), CollisionClass::kPotential);
    const OverlapRegion& region = result.regions[0];
    EXPECT_NEAR(region.delta_mm.hi - region.possible_mm.hi, -0.2, 2e-4);
    EXPECT_NEAR(region.delta_mm.lo - region.certain_mm.lo, 0.2, 2e-4);
    EXPECT_FALSE(region.capped);
  }
  EXPECT_EQ(agreed_class(tab_in_slot(0.2)), CollisionClass::kNone);
  EXPECT_EQ(agreed_class(tab_in_slot(0.25)), CollisionClass::kNone);
  EXPECT_EQ(agreed_class(tab_in_slot(-0.25)), CollisionClass::kReal);
}

/// Two blocks in one mesh; points that both have are one.
SolidPtr joined(const SolidPtr& a, const SolidPtr& b) {
  TriangleMesh mesh = a->mesh();
  std::vector<std::uint32_t> at;
  for (const Vec3& p : b->mesh().points_mm) {
    const auto known = std::find(mesh.points_mm.begin(), mesh.points_mm.end(), p);
    at.push_back(static_cast<std::uint32_t>(known - mesh.points_mm.begin()));
    if (known == mesh.points_mm.end()) mesh.points_mm.push_back(p);
  }
  for (const auto& [i, j, k] : b->mesh().triangles) mesh.triangles.push_back({at[i], at[j], at[k]});
  return std::make_shared<const Solid>(std::move(mesh));
}

/// Written to a file of single precision, turned as it may lie in an assembly.
SolidPtr turned(const SolidPtr& solid, const Pose& X) {
  TriangleMesh mesh = solid->mesh();
  for (Vec3& p : mesh.points_mm) p = (X * p).cast<float>().cast<double>();
  return std::make_shared<const Solid>(std::move(mesh));
}

SurfaceBand plus_minus_of_file(const SolidPtr& solid, double t_mm) {
  BandInput input;
  input.solid = solid.get();
  input.estimate = true;
  input.rest = {{-t_mm, t_mm}, "plus minus"};
  input.quantum_mm = 2e-6;  // half a step of single precision at 60 mm
  return build_band(input);
}

// What two bodies have beside each other where they share an edge or a corner makes no tip.
TEST(PlanePair, BodiesThatShareAnEdgeOrACornerAreDecided) {
  Pose X;
  X.q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  X.p = Vec3(17, -33, 21);
  for (const double step_mm : {0.0, 20.0}) {
    const SolidPtr both =
        joined(block({-20, -20, -20}, {0, 0, 0}), block({0, 0, -20 + step_mm}, {20, 20, step_mm}));
    ASSERT_EQ(both->topology().manifold(), false);
    for (const double t_mm : {0.0, 0.01})
      for (const double overlap_mm : {0.03, 0.001, -0.001, -0.03}) {
        OverlapCase c;
        c.a = turned(both, X);
        // Beside the shared edge; below the shared corner.
        const double z_mm = step_mm > 0.0 ? -20.0 + overlap_mm : overlap_mm;
        c.b = turned(step_mm > 0.0 ? block({-4, -4, z_mm - 8.0}, {4, 4, z_mm})
                                   : block({-4, -4, -z_mm}, {4, 4, 8.0 - z_mm}),
                     X);
        c.band_a = plus_minus_of_file(c.a, t_mm);
        c.band_b = plus_minus_of_file(c.b, 0.0);
        const CollisionClass told = agreed_class(c);
        const bool free = told == CollisionClass::kNone || told == CollisionClass::kFake;
        const bool right = overlap_mm > t_mm    ? told == CollisionClass::kReal
                           : overlap_mm > -t_mm ? told == CollisionClass::kPotential
                                                : free;
        EXPECT_TRUE(right) << step_mm << " " << t_mm << " " << overlap_mm << " "
                           << static_cast<int>(told);
      }
  }
}

TEST(PlanePair, AnEdgeThatTwoBodiesShareHasTheTipsOfBoth) {
  const SolidPtr one = block({-20, -20, -20}, {0, 0, 0}), other = block({0, 0, -20}, {20, 20, 0});
  const SolidPtr both = joined(one, other);
  EXPECT_EQ(find_tips(*both, plus_minus(both, 0.1)).size(),
            2 * find_tips(*one, plus_minus(one, 0.1)).size());
}

SurfaceBand recognized_of_file(const SolidPtr& solid) {
  const std::vector<Feature> features = recognize_features(*solid).features;
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature.resize(features.size());
  input.estimate = true;
  input.quantum_mm = 2e-6;
  return build_band(input);
}

// Each coordinate is off by half a step, so a corner is off across a face askew by up to 1.73 of
// it.
TEST(PlanePair, WhatTouchesAskewIsNotRealByTheRoundingOfItsFile) {
  constexpr double kQuantum_mm = 5e-4;
  std::mt19937_64 random(61);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 10; ++i) {
    Pose X;
    X.q = Quat(any(random), any(random), any(random), any(random)).normalized();
    // Both files were rounded towards the other part.
    const Vec3 off = kQuantum_mm * (X.q * Vec3::UnitZ()).array().sign();
    const auto of_file = [](const SolidPtr& solid) {
      BandInput input;
      input.solid = solid.get();
      input.quantum_mm = kQuantum_mm;
      return build_band(input);
    };
    OverlapCase c;
    X.p = off;
    c.a = turned(block({-20, -20, -10}, {20, 20, 0}), X);
    X.p = -off;
    c.b = turned(block({-7, -5, 0}, {8, 6, 9}), X);
    c.band_a = of_file(c.a);
    c.band_b = of_file(c.b);
    EXPECT_NE(agreed_class(c), CollisionClass::kReal) << i;
    X.p *= 1.01;
    c.b = turned(block({-7, -5, 0}, {8, 6, 9}), X);
    c.band_b = of_file(c.b);
    EXPECT_NE(agreed_class(c), CollisionClass::kNone) << i;
  }
}

// A sharp edge travels farther than its faces, also by the rounding of a file.
TEST(PlanePair, AnEdgeThatTouchesIsNoCollisionByRoundingAlone) {
  Pose X;
  X.q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  X.p = Vec3(17, -33, 21);
  OverlapCase c;
  c.a = turned(block({-20, -20, -10}, {20, 20, 0}), X);
  c.b = turned(wedge(20 * kDegree), X);
  c.band_a = recognized_of_file(c.a);
  c.band_b = recognized_of_file(c.b);
  // As it lies after rounding: moved up to where it just touches.
  const Vec3 up = X.q * Vec3::UnitZ();
  double gap_mm = 0.0;
  CcdScratch scratch;
  for (int i = 0; i < 20 && !(gap_mm > 1e-7 && gap_mm < 5e-7); ++i) {
    c.X_WB.p += (i == 0 ? 1e-3 : 3e-7 - gap_mm) * up;
    gap_mm = distance(*c.a, c.X_WA, *c.b, c.X_WB, scratch).distance_mm;
  }
  ASSERT_NEAR(gap_mm, 3e-7, 2e-7);
  EXPECT_EQ(agreed_class(c), CollisionClass::kNone);
}

// A bar that is tilted in its hole as far as it can be: edges cross, and the search of triangles
// cannot tell that nothing overlaps where they touch. Their planes tell, before that search ends.
TEST(PlanePair, ABarThatTouchesItsHoleAtManyEdgesIsApart) {
  polyhedra::Random random(5);
  for (int i = 0; i < test::effort(4); ++i) {
    const int sides = 3 + i % 6;
    const auto section = [&](double radius_mm) {
      return shapes::ellipse(radius_mm, radius_mm, sides, 0.2);
    };
    const double less_mm = polyhedra::between(random, 0.01, 0.2);
    OverlapCase c;
    c.a = shapes::solid(shapes::plate_with_hole(section(7.0), 0.0, 10.0));
    c.b = shapes::solid(shapes::lofted({shapes::at_height(section(7.0 - less_mm), -5.0),
                                        shapes::at_height(section(7.0 - less_mm), 15.0)}));
    Vec3 axis = polyhedra::direction(random);
    axis.z() = 0.0;
    const auto tilted = [&](double by_rad) {
      const Pose about{Quat::Identity(), Vec3(0, 0, 5)};
      return about * Pose{rotation_exp(by_rad * axis.normalized()), Vec3::Zero()} * about.inverse();
    };
    double free_rad = 0.0, met_rad = 0.2;
    CcdScratch scratch;
    for (int k = 0; k < 60; ++k) {
      const double tilt_rad = 0.5 * (free_rad + met_rad);
      const double gap_mm = distance(*c.a, c.X_WA, *c.b, tilted(tilt_rad), scratch).distance_mm;
      (gap_mm > 1e-7 ? free_rad : met_rad) = tilt_rad;
    }
    c.X_WB = tilted(free_rad);
    EXPECT_EQ(agreed_class(c), CollisionClass::kNone) << i;
    EXPECT_LT(overlap_of(c).evaluations, OverlapQuery().work_cap / 10) << i;
  }
}

// The classes of find_overlap against linear programs over the half-spaces.
template <class Make>
void compare(Make make, int pairs, std::uint64_t seed) {
  polyhedra::Random random(seed);
  int decided = 0, other = 0;
  for (int i = 0; i < pairs; ++i) {
    const polyhedra::Polyhedron a = make(random), b = make(random);
    OverlapCase c;
    c.a = a.solid;
    c.b = b.solid;
    c.band_a = a.band;
    c.band_b = b.band;
    c.refinement = i % 4 == 0 ? Refinement::kFull : Refinement::kDecided;
    c.X_WA.q = polyhedra::rotation(random);
    const Vec3 along = polyhedra::direction(random);
    double in = 0.0, out = 20.0;
    for (int k = 0; k < 12; ++k) {
      c.X_WA.p = 0.5 * (in + out) * along;
      (polyhedra::true_margin(a, b, c.X_WA, polyhedra::Body::kLargest) > 0.05 ? in : out) =
          0.5 * (in + out);
    }
    c.X_WA.p += polyhedra::between(random, -0.15, 0.1) * along;
    const double least = polyhedra::true_margin(a, b, c.X_WA, polyhedra::Body::kLeast);
    const double largest = polyhedra::true_margin(a, b, c.X_WA, polyhedra::Body::kLargest);
    const CollisionClass told = worst_class(overlap_of(c));
    const bool free = told == CollisionClass::kNone || told == CollisionClass::kFake;
    EXPECT_FALSE(told == CollisionClass::kReal && !(least > 0.0)) << i << " " << least;
    EXPECT_FALSE(free && largest > 1e-6) << i << " " << largest;
    if (std::fabs(least) < 5e-4 || std::fabs(largest) < 5e-4) continue;
    const bool right = least > 0.0     ? told == CollisionClass::kReal
                       : largest > 0.0 ? told == CollisionClass::kPotential
                                       : free;
    ++(right ? decided : other);
  }
  std::printf("%d as they are, %d potential\n", decided, other);
  EXPECT_LE(20 * other, decided);
}

TEST(PlanePair, ConvexPairsHaveTheClassOfTheirHalfSpaces) {
  compare(polyhedra::random_convex, test::effort(60), 2718);
}

TEST(PlanePair, UnionsAndDifferencesOfBoxesHaveTheClassOfTheirHalfSpaces) {
  compare(polyhedra::random_boxes, test::effort(30), 3141);
}

}  // namespace
}  // namespace mortise
