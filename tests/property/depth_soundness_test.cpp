// Admissible real parts never contradict a verdict: for random fits, tessellations and poses, radii
// are drawn inside the declared zones and the true gap of the true cylinders is computed in closed
// form. Real: every draw interferes. Fake or nothing: none does.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/depth/depth.h"
#include "common/evaluation/verdict.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr double kRadius_mm = 10.0;

struct Fit {
  SolidPtr shaft, hole;
  SurfaceBand shaft_band, hole_band;
  Interval shaft_offset_mm, hole_offset_mm;
  Pose X_WA, X_WB;
};

// Overlap of a true shaft in a true hole, both 20 mm long where they meet, nearly parallel axes:
// largest distance of the axes at the ends of the common length, plus radii.
double true_overlap_mm(const Fit& fit, double shaft_offset_mm, double hole_offset_mm) {
  const Pose X_BA = fit.X_WB.inverse() * fit.X_WA;
  double apart = 0.0;
  for (const double z : {0.0, 15.0}) {
    const Vec3 c = X_BA * Vec3(0, 0, z);
    apart = std::max(apart, std::hypot(c.x(), c.y()));
  }
  return apart + (kRadius_mm + shaft_offset_mm) - (kRadius_mm - hole_offset_mm);
}

CollisionClass judge(const Fit& fit) {
  OverlapQuery query;
  query.a = fit.shaft.get();
  query.b = fit.hole.get();
  query.band_a = &fit.shaft_band;
  query.band_b = &fit.hole_band;
  query.X_WA = fit.X_WA;
  query.X_WB = fit.X_WB;
  CcdScratch scratch;
  const OverlapResult result = find_overlap(query, scratch);
  CollisionClass worst = CollisionClass::kNone;
  for (const OverlapRegion& region : result.regions)
    worst = std::max(worst, classify({region.delta_mm, region.certain_mm, region.possible_mm,
                                      region.has_witness, result.no_inside}));
  return worst;
}

Fit random_fit(std::mt19937_64& random, bool exact_features) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::uniform_int_distribution<int> facets(24, 60);
  Fit fit;
  const int n = exact_features ? facets(random) : 180 + facets(random);
  const int m = exact_features ? facets(random) : n;
  fit.shaft = solid(peg({kRadius_mm, -5, 15, n, 1, unit(random)}));
  fit.hole = solid(ring({kRadius_mm, 0, 20, m, 1, unit(random)}, 20));
  const double middle = -0.02 + 0.03 * unit(random);
  fit.shaft_offset_mm = {middle - 0.006 * unit(random), middle + 0.006 * unit(random)};
  fit.hole_offset_mm = {-0.01 * unit(random), 0.0};
  if (exact_features) {
    fit.shaft_band = cylinder_band(fit.shaft, kRadius_mm, false, fit.shaft_offset_mm);
    fit.hole_band = cylinder_band(fit.hole, kRadius_mm, true, fit.hole_offset_mm);
  } else {
    const double s = kRadius_mm * (1 - std::cos(std::numbers::pi / n));
    fit.shaft_band = uniform_band({0, s}, fit.shaft_offset_mm);
    fit.hole_band = uniform_band({-s, 0}, fit.hole_offset_mm);
    // Faces other than the cylinders touch nothing here.
  }
  fit.X_WB = random_pose(random, 100.0);
  const double angle = 2.0 * std::numbers::pi * unit(random);
  const Vec3 shift = 0.012 * unit(random) * Vec3(std::cos(angle), std::sin(angle), 0.0);
  fit.X_WA =
      fit.X_WB * Pose{rotation_exp(3e-4 * Vec3(unit(random) - 0.5, unit(random) - 0.5, 0)), shift};
  return fit;
}

struct Contradictions {
  int contradictions = 0, real = 0, fake = 0, potential = 0, potential_in_vain = 0;
};

Contradictions play(std::uint64_t seed, int rounds, bool exact_features, double planted_mm) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Contradictions tally;
  for (int i = 0; i < rounds; ++i) {
    const Fit fit = random_fit(random, exact_features);
    const CollisionClass verdict = judge(fit);
    tally.real += verdict == CollisionClass::kReal;
    tally.fake += verdict <= CollisionClass::kFake;
    tally.potential += verdict == CollisionClass::kPotential;
    bool all = true, none = true;
    for (int draw = 0; draw < 200; ++draw) {
      // The corners of the zones first.
      const double u = draw < 4 ? draw % 2 : unit(random), v = draw < 4 ? draw / 2 : unit(random);
      const double overlap =
          true_overlap_mm(fit, fit.shaft_offset_mm.lo + u * fit.shaft_offset_mm.width(),
                          fit.hole_offset_mm.lo + v * fit.hole_offset_mm.width()) +
          planted_mm;
      // Within the accuracy of touch either word is right; the tilted circle gives 1e-6.
      if (overlap > 2e-6 && verdict <= CollisionClass::kFake) ++tally.contradictions;
      if (overlap < -2e-6 && verdict == CollisionClass::kReal) ++tally.contradictions;
      all &= overlap > 2e-6;
      none &= overlap < -2e-6;
    }
    if (verdict == CollisionClass::kPotential) tally.potential_in_vain += all || none;
  }
  return tally;
}

TEST(DepthSoundness, NoAdmissibleFitContradictsAVerdict) {
  const Contradictions exact = play(101, test::effort(60), true, 0.0);
  EXPECT_EQ(exact.contradictions, 0);
  EXPECT_GT(exact.real, 2);
  EXPECT_GT(exact.fake, 5);
  EXPECT_GT(exact.potential, 5);
  // Exact features leave nothing open that the zones do not.
  EXPECT_LE(exact.potential_in_vain, 3);
  const Contradictions chord = play(102, test::effort(12), false, 0.0);
  EXPECT_EQ(chord.contradictions, 0);
}

// The check itself sees a fault of 5 um.
TEST(DepthSoundness, APlantedFaultIsSeen) {
  EXPECT_GT(play(101, 60, true, 0.005).contradictions, 0);
  EXPECT_GT(play(101, 60, true, -0.005).contradictions, 0);
}

// delta.hi is above and delta.lo is reached by dense sampling of both surfaces.
TEST(DepthSoundness, BracketHoldsAgainstDenseSampling) {
  std::mt19937_64 random(55);
  const SurfaceBand nominal = nominal_band();
  int overlapping = 0;
  for (int i = 0; i < 25; ++i) {
    const SolidPtr a = solid(i % 2 == 0 ? box({1, .6, .4}, Vec3::Zero(), 2) : sphere(0.9));
    const SolidPtr b = solid(i % 3 == 0 ? peg({.7, -1, 1, 9, 1, 0}) : u_slot(2, .7, 1, .6, -1, 1));
    OverlapQuery query;
    query.a = a.get();
    query.b = b.get();
    query.band_a = query.band_b = &nominal;
    query.X_WA = random_pose(random, 0.9);
    query.X_WB = random_pose(random, 0.9);
    query.refinement = Refinement::kFull;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    double deepest = -1e9;
    const auto sample = [&](const Solid& s, const Solid& k, const Pose& X_KS) {
      std::uniform_real_distribution<double> unit(0.0, 1.0);
      for (std::uint32_t t = 0; t < s.mesh().triangles.size(); ++t)
        for (int j = 0; j < 40; ++j) {
          double u = unit(random), v = unit(random);
          if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
          const Vec3 x = (1 - u - v) * s.mesh().corner(t, 0) + u * s.mesh().corner(t, 1) +
                         v * s.mesh().corner(t, 2);
          deepest = std::max(deepest, -signed_distance_mm(k, X_KS * x));
        }
    };
    sample(*a, *b, query.X_WB.inverse() * query.X_WA);
    sample(*b, *a, query.X_WA.inverse() * query.X_WB);
    double lo = -1e9, hi = 1e-6;
    for (const OverlapRegion& region : result.regions) {
      lo = std::max(lo, region.delta_mm.lo);
      hi = std::max(hi, region.delta_mm.hi);
      EXPECT_LE(region.delta_mm.width(), 1.1e-4);
    }
    EXPECT_LE(deepest, hi) << i;
    if (result.regions.empty()) continue;
    ++overlapping;
    EXPECT_GE(lo, deepest - 1.1e-4) << i;
  }
  EXPECT_GT(overlapping, 8);
}

}  // namespace
}  // namespace mortise
