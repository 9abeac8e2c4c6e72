#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/evaluation/interference_draws.h"
#include "common/evaluation/tolerance.h"
#include "common/evaluation/verdict.h"

namespace mortise {
namespace {

constexpr std::uint64_t kDraws = 200'000;

double closed_form(const InterferenceZones& z) {
  return interference_probability(z.certain_mm, z.possible_mm, z.tolerance_a_mm, z.tolerance_b_mm);
}

void expect_agreement(const InterferenceZones& zones, std::uint64_t seed) {
  const double p = closed_form(zones);
  const InterferenceEstimate drawn = draw_interference(zones, seed, kDraws);
  ASSERT_EQ(drawn.draws, kDraws);
  // Where hardly any draw falls on the other side, one count more or less is no disagreement.
  EXPECT_NEAR(drawn.probability(), p, 4.0 * drawn.sampling_error(p) + 1.5 / kDraws) << seed;
}

InterferenceZones zones_of(const char* code, double nominal_mm) {
  Surface hole, shaft;
  hole.kind = shaft.kind = SurfaceKind::kCylinder;
  hole.radius_mm = shaft.radius_mm = 0.5 * nominal_mm;
  hole.inward = true;
  const auto fit = fit_statement(code, nominal_mm, {&hole, 0.0, "bore"}, {&shaft, 0.0, "pin"});
  EXPECT_TRUE(fit) << code;
  const Interval sum = fit->a.offset_mm + fit->b.offset_mm;
  return {{sum.lo, sum.lo}, {sum.hi, sum.hi}, fit->a.offset_mm, fit->b.offset_mm};
}

TEST(InterferenceDraws, AgreeWithTheClosedFormForTheStandardFits) {
  std::uint64_t seed = 1;
  for (const char* code : {"H7/g6", "H7/h6", "H7/k6", "H7/n6", "H7/p6", "H8/f7", "H7/js6"})
    for (const double nominal : {3.0, 20.0, 250.0})
      expect_agreement(zones_of(code, nominal), ++seed);
  // The printed probabilities of a 20 mm pair, met by drawing alone.
  const auto drawn = [](const char* code) {
    return draw_interference(zones_of(code, 20.0), 77, kDraws).probability();
  };
  EXPECT_NEAR(drawn("H7/k6"), 0.31353, 0.0042);
  EXPECT_NEAR(drawn("H7/n6"), 0.99623, 0.0006);
}

// Zones that lie unevenly about the modelled surface, overlap that is not zero, and doubt about the
// mesh of any size beside the tolerances.
TEST(InterferenceDraws, AgreeWithTheClosedFormAtRandomZones) {
  std::mt19937_64 random(20240607);
  std::uniform_real_distribution<double> end(-0.05, 0.05), doubt(0.0, 0.06);
  int decided = 0;
  for (std::uint64_t i = 0; i < 120; ++i) {
    const auto zone = [&] {
      const double x = end(random), y = end(random);
      return Interval{std::min(x, y), std::max(x, y)};
    };
    InterferenceZones z;
    z.tolerance_a_mm = zone();
    z.tolerance_b_mm = i % 5 == 0 ? Interval{} : zone();
    const double meshes = end(random) - (z.tolerance_a_mm + z.tolerance_b_mm).middle();
    const double lo = meshes + z.tolerance_a_mm.lo + z.tolerance_b_mm.lo;
    const double hi =
        meshes + z.tolerance_a_mm.hi + z.tolerance_b_mm.hi + (i % 3 == 0 ? 0.0 : doubt(random));
    z.certain_mm = {lo, lo};
    z.possible_mm = {hi, hi + doubt(random)};  // upper ends may stay wide: they must not matter
    expect_agreement(z, 1000 + i);
    const double p = closed_form(z);
    decided += p > 0.02 && p < 0.98 ? 1 : 0;
  }
  EXPECT_GT(decided, 40);
}

TEST(InterferenceDraws, TheSameSeedCountsTheSame) {
  const InterferenceZones zones = zones_of("H7/k6", 20.0);
  const auto count = [&](std::uint64_t seed) {
    return draw_interference(zones, seed, 5000).interfering;
  };
  EXPECT_EQ(count(5), count(5));
  EXPECT_NE(count(5), count(6));
}

TEST(InterferenceDraws, WithoutAnySpreadItIsAStep) {
  EXPECT_EQ(draw_interference({{0.1, 0.1}, {0.1, 0.1}, {}, {}}, 1, 100).interfering, 100U);
  EXPECT_EQ(draw_interference({{-0.1, -0.1}, {-0.1, -0.1}, {}, {}}, 1, 100).interfering, 0U);
}

}  // namespace
}  // namespace mortise
