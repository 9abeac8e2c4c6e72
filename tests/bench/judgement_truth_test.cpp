// The truth that the benchmark judges by, itself held against dense sampling and against depths of
// meshes found by brute force.
#include "tests/bench/judgement_truth.h"
#include "common/geometry/recognition/recognition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/signed_distance.h"
#include "tests/bench/judgement_realization.h"
#include "tests/bench/judgement_score.h"

namespace mortise::bench {
namespace {

constexpr Family kRoundFamilies[] = {Family::kCylinder, Family::kCone, Family::kBall};

// Largest difference of closed form and dense sampling over corners of the zones.
double worst_difference_mm(Family family, int cases, double planted_mm) {
  double worst = 0.0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(cases); ++seed) {
    const JudgedCase c = draw_case(family, seed);
    Dice dice(seed);
    for (const bool whole : {false, true})
      for (int corner = 0; corner < 4; ++corner) {
        const Realization drawn = draw_realization(c, whole, corner, dice);
        const double a = drawn.a.offset_mm(0.0, 0.0), b = drawn.b.offset_mm(0.0, 0.0);
        const double exact = c.overlap_mm({a, b, drawn.a.rest_mm, drawn.b.rest_mm}) + planted_mm;
        const auto sampled = sampled_overlap_mm(c, drawn);
        EXPECT_TRUE(sampled.has_value());
        worst = std::max(worst, std::abs(exact - sampled.value_or(1e9)));
      }
  }
  return worst;
}

TEST(JudgementTruth, ClosedFormsAgreeWithDenseSampling) {
  for (const Family family : kRoundFamilies)
    EXPECT_LT(worst_difference_mm(family, 40, 0.0), kTouch_mm) << name_of(family);
}

TEST(JudgementTruth, APlantedErrorIsSeen) {
  for (const Family family : kRoundFamilies)
    EXPECT_GT(worst_difference_mm(family, 5, 2.0 * kTouch_mm), kTouch_mm) << name_of(family);
}

// Every drawn surface lies between the least and the largest: what the benchmark's soundness rests
// on.
TEST(JudgementTruth, DrawnSurfacesStayBetweenTheLimits) {
  int shaped = 0;
  for (const Family family : kRoundFamilies)
    for (std::uint64_t seed = 100; seed < 130; ++seed) {
      const JudgedCase c = draw_case(family, seed);
      const Truth truth = c.truth(false);
      Dice dice(seed);
      for (int i = 4; i < 10; ++i) {
        const double overlap = *sampled_overlap_mm(c, draw_realization(c, false, i, dice));
        EXPECT_GE(overlap, truth.certain_mm - kTouch_mm) << name_of(family) << ":" << seed;
        EXPECT_LE(overlap, truth.possible_mm + kTouch_mm) << name_of(family) << ":" << seed;
        shaped += overlap > truth.certain_mm + 1e-4 && overlap < truth.possible_mm - 1e-4;
      }
    }
  EXPECT_GT(shaped, 50);
}

// Deepest point of the shaft's corner lines in the hole's mesh, middle of the common height.
TEST(JudgementTruth, PolygonDepthIsThatOfTheMeshes) {
  int asked = 0;
  for (std::uint64_t seed = 0; asked < 40; ++seed) {
    const JudgedCase c = draw_case(Family::kCylinder, seed);
    if (!c.mesh_depth_mm || c.a.facets > 100) continue;
    ++asked;
    const RoundFit& fit = std::get<RoundFit>(c.shape);
    const double z = 0.5 * std::min(fit.hole.z1_mm, fit.shaft.z1_mm);
    double deepest = -1e9;
    for (int i = 0; i < 2; ++i)
      for (const Vec3& p : c.a.solid->mesh().points_mm) {
        if (std::hypot(p.x(), p.y()) < 1e-9) continue;
        deepest =
            std::max(deepest, -signed_distance_mm(*c.b.solid, fit.X_BA * Vec3(p.x(), p.y(), z)));
      }
    EXPECT_NEAR(deepest, *c.mesh_depth_mm, 1e-9) << seed;
  }
}

TEST(JudgementTruth, KnownFits) {
  // Ø20 H7, R 10, coaxial: the worked example of the design.
  const RoundFit fit{{10, -5, 10, 15}, {10, 0, 10, 20}, Pose()};
  EXPECT_NEAR(round_overlap_mm(fit, {-0.010, -0.0105, 0, 0}), -0.0205, 1e-12);
  EXPECT_NEAR(round_overlap_mm(fit, {-0.0035, 0.0, 0, 0}), -0.0035, 1e-12);
  EXPECT_NEAR(polygon_depth_mm({10, 10, {32, std::numbers::pi / 32}, {32, 0}, Vec3::Zero(), 0}),
              0.048152733, 1e-9);
  EXPECT_NEAR(polygon_depth_mm({10.01, 10, {32, 0}, {32, 0}, Vec3::Zero(), 0}), 0.01, 1e-12);
}

// Twelve facets around, and the fan at the pole meets its neighbours more sharply than other rows
// do: still one ball, with no cone at its end.
TEST(JudgementParts, TheSocketOfFewestFacetsIsOneBall) {
  for (const double rim_mm : {57.0, 0.0, -20.0, 100.0}) {
    const JudgedPart part = make_socket(237.0, rim_mm, 356.0, {12, 0.1});
    for (const Feature& f : recognize_features(*part.solid).features) {
      EXPECT_NE(f.surface.kind, SurfaceKind::kCone) << rim_mm;
      if (f.surface.kind == SurfaceKind::kSphere) {
        EXPECT_NEAR(f.surface.radius_mm, 237.0, 1e-6) << rim_mm;
      }
    }
  }
}

}  // namespace
}  // namespace mortise::bench
