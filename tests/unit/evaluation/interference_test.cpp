#include "common/evaluation/interference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/evaluation/interference_draws.h"
#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

constexpr std::uint64_t kDraws = 200'000;

// Both layers of a modelled overlap, exactly known.
InterferenceZones zones_at(double modelled_mm, Interval size_a, Interval size_b, double place_a = 0,
                           double place_b = 0, std::optional<ParallelAxes> axes = {}) {
  const double place_mm = 0.5 * (place_a + place_b);
  const double lo = modelled_mm + size_a.lo + size_b.lo - place_mm;
  const double hi = modelled_mm + size_a.hi + size_b.hi + place_mm;
  return {{lo, lo}, {hi, hi}, size_a, size_b, place_a, place_b, axes};
}

double p_of(const InterferenceZones& zones) {
  const auto p = interference_probability(zones);
  EXPECT_TRUE(p);
  return p ? p->middle() : -1.0;
}

void expect_agreement(const InterferenceZones& zones, std::uint64_t seed) {
  const double p = p_of(zones);
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
  return zones_at(0.0, fit->a.offset_mm, fit->b.offset_mm);
}

TEST(Interference, NumbersOfTheStandardFits) {
  EXPECT_NEAR(p_of(zones_of("H7/g6", 20)), 2.76e-9, 0.01e-9);
  EXPECT_NEAR(p_of(zones_of("H7/h6", 20)), 1.81e-5, 0.01e-5);
  EXPECT_NEAR(p_of(zones_of("H7/k6", 20)), 0.31353, 1e-5);
  EXPECT_NEAR(p_of(zones_of("H7/n6", 20)), 0.99623, 1e-5);
  EXPECT_NEAR(p_of(zones_of("H7/p6", 20)), 0.9999939, 1e-7);
  EXPECT_NEAR(p_of(zones_of("H8/f7", 20)), 2.8e-13, 0.05e-13);
}

TEST(Interference, AgreesWithDrawsForTheStandardFits) {
  std::uint64_t seed = 1;
  for (const char* code : {"H7/g6", "H7/h6", "H7/k6", "H7/n6", "H7/p6", "H8/f7", "H7/js6"})
    for (const double nominal : {3.0, 20.0, 250.0})
      expect_agreement(zones_of(code, nominal), ++seed);
}

// A pin Ø10 g6 in a hole Ø10 H7 whose axis is anywhere in a zone, coaxial as modelled. The numbers
// are those of 2e7 draws of both diameters and both components of the axis, made apart from this
// program: 5.976 % and 25.350 %.
TEST(Interference, APositionZoneIsDrawnAcrossTheAxis) {
  InterferenceZones zones = zones_of("H7/g6", 10);
  const auto at = [&](double zone_mm) {
    return p_of(zones_at(0.0, zones.size_a_mm, zones.size_b_mm, zone_mm, 0.0, ParallelAxes{}));
  };
  EXPECT_NEAR(at(0.020), 0.05976, 0.0002);
  EXPECT_NEAR(at(0.030), 0.25350, 0.0004);
}

// Of coaxial faces the length of a normal vector has a closed form, and the sum with a normal size.
TEST(Interference, CoaxialFacesHaveAClosedForm) {
  const auto phi = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  for (const double size : {0.003, 0.01, 0.06})
    for (const double gap : {-0.004, 0.002, 0.0085, 0.015}) {
      const double s = size / 6.0, e = 0.02 / 6.0, both = std::hypot(s, e);
      const double p = phi(-gap / s) + e / both * std::exp(-0.5 * gap * gap / both / both) *
                                           phi(gap * e / s / both);
      const Interval half{-0.5 * size, 0.5 * size};
      EXPECT_NEAR(p_of(zones_at(-gap, half, {}, 0.0, 0.02, ParallelAxes{})), p, 1e-6 + 1e-5 * p)
          << size << " " << gap;
    }
}

// Modelled as far apart as the zones are wide, where the distance of the axes is least normal. The
// numbers are those of a quadrature over rings of places and the share of their arcs, made apart
// from this program.
TEST(Interference, AxesThatAreModelledApartAreExact) {
  struct {
    double modelled_mm, size_mm, place_a_mm, place_b_mm, apart_mm;
    bool nested;
    double p;
  } const cases[] = {{-0.002, 6 * 0.001201850425154663, 0.05, 0.005, 0.005, true, 0.7432687},
                     {0.006, 6 * 0.0009428090415820635, 0.1, 0.02, 0.01, true, 0.9757689},
                     {0.0043, 0.0, 0.06, 0.0, 0.03, true, 0.7304498},
                     {0.0043, 0.0, 0.0, 0.06, 0.03, false, 0.6070446}};
  for (const auto& c : cases) {
    const Interval half{-0.5 * c.size_mm, 0.5 * c.size_mm};
    const ParallelAxes axes{c.apart_mm, c.nested};
    EXPECT_NEAR(p_of(zones_at(c.modelled_mm, half, {}, c.place_a_mm, c.place_b_mm, axes)), c.p,
                2e-5)
        << c.modelled_mm << " " << c.apart_mm;
  }
}

// Unevenly lying zones, faces without a size tolerance, zones of one or both axes, axes apart by
// nothing to much more than the zones, in a hole and side by side.
TEST(Interference, AgreesWithDrawsAtRandomZones) {
  std::mt19937_64 random(20240607);
  std::uniform_real_distribution<double> end(-0.05, 0.05), zone(0.0, 0.1);
  int decided = 0;
  for (std::uint64_t i = 0; i < 160; ++i) {
    const auto size = [&] {
      const double x = end(random), y = end(random);
      return Interval{std::min(x, y), std::max(x, y)};
    };
    const Interval a = size(), b = i % 5 == 0 ? Interval{} : size();
    const double place_a = i % 2 == 0 ? 0.0 : zone(random);
    const double place_b = i % 3 == 0 ? 0.0 : zone(random);
    const double apart = i % 4 == 0 ? 0.0 : i % 7 == 0 ? 20.0 : zone(random);
    const double modelled = end(random) - (a + b).middle();
    const InterferenceZones zones =
        zones_at(modelled, a, b, place_a, place_b, ParallelAxes{apart, i % 11 != 0});
    expect_agreement(zones, 1000 + i);
    const double p = p_of(zones);
    decided += p > 0.02 && p < 0.98 ? 1 : 0;
  }
  EXPECT_GT(decided, 50);
}

TEST(Interference, TheSameSeedCountsTheSame) {
  const InterferenceZones zones = zones_of("H7/k6", 20.0);
  const auto count = [&](std::uint64_t seed) {
    return draw_interference(zones, seed, 5000).interfering;
  };
  EXPECT_EQ(count(5), count(5));
  EXPECT_NE(count(5), count(6));
}

// What is clear, or not known, is no chance.
TEST(Interference, IsKnownOnlyOfDeclaredTolerances) {
  EXPECT_FALSE(interference_probability(zones_at(0.1, {}, {})));
  InterferenceZones zones = zones_at(0.001, {-0.01, 0.0}, {-0.01, 0.01});
  EXPECT_TRUE(interference_probability(zones));
  // Mesh error beside the tolerances, or a bracket that was left open.
  InterferenceZones doubtful = zones;
  doubtful.possible_mm = {zones.possible_mm.lo + 0.002, zones.possible_mm.hi + 0.002};
  EXPECT_FALSE(interference_probability(doubtful));
  doubtful = zones;
  doubtful.possible_mm.hi += 1.0;
  EXPECT_FALSE(interference_probability(doubtful));
  doubtful = zones;
  doubtful.certain_mm.lo += 0.002;  // other faces make one of the layers
  EXPECT_FALSE(interference_probability(doubtful));
  doubtful = zones;
  doubtful.certain_mm.lo = -std::numeric_limits<double>::infinity();
  EXPECT_FALSE(interference_probability(doubtful));
  // A place that is not drawn.
  EXPECT_FALSE(interference_probability(zones_at(0.001, {-0.01, 0.0}, {}, 0.02)));
  EXPECT_TRUE(interference_probability(zones_at(0.001, {}, {}, 0.02, 0.0, ParallelAxes{})));
}

TEST(Interference, IsAsUncertainAsTheOverlap) {
  InterferenceZones zones = zones_at(0.001, {-0.01, 0.0}, {-0.01, 0.01});
  zones.certain_mm.lo -= 0.0005;
  zones.possible_mm.hi += 0.0005;
  const auto p = interference_probability(zones);
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->lo, p_of(zones_at(0.0005, {-0.01, 0.0}, {-0.01, 0.01})), 1e-12);
  EXPECT_NEAR(p->hi, p_of(zones_at(0.0015, {-0.01, 0.0}, {-0.01, 0.01})), 1e-12);
}

TEST(Interference, ASurfaceIsKnownByDeclarationOrRecognition) {
  SurfaceBand::Face face;
  const auto known = [&](DeviationGrade grade, FaceShape shape) {
    face.grade = grade;
    return is_surface_known(face, shape);
  };
  EXPECT_TRUE(known(DeviationGrade::kDeclaredFeature, FaceShape::kConvex));
  EXPECT_TRUE(known(DeviationGrade::kRecognizedFeature, FaceShape::kConcave));
  EXPECT_TRUE(known(DeviationGrade::kPlanar, FaceShape::kPlanar));
  EXPECT_TRUE(known(DeviationGrade::kNominal, FaceShape::kPlanar));
  EXPECT_FALSE(known(DeviationGrade::kNominal, FaceShape::kConvex));
  EXPECT_FALSE(known(DeviationGrade::kDeclaredChord, FaceShape::kPlanar));
  EXPECT_FALSE(known(DeviationGrade::kEstimated, FaceShape::kConvex));
}

TEST(Interference, AxesAreThoseOfTwoCylindersAtTheirPoses) {
  SurfaceBand::Face hole, pin;
  hole.surface.emplace();
  hole.surface->kind = SurfaceKind::kCylinder;
  hole.surface->inward = true;
  hole.tolerance_mm = {-0.01, 0.0};
  pin = hole;
  pin.surface->inward = false;
  pin.surface->point = Vec3(0, 0, 7);
  MeetingFaces pair{&hole, &pin, {}, Pose::translation({0.03, 0.04, 5}), Vec3(1, 2, 3), 10.0};
  const auto axes = parallel_axes(pair);
  ASSERT_TRUE(axes);
  EXPECT_NEAR(axes->apart_mm, 0.05, 1e-12);
  EXPECT_TRUE(axes->nested);
  // Slightly tilted: where the faces meet counts; the other way round is as good.
  pair.X_WB.q = Quat(Eigen::AngleAxisd(1e-5, Vec3::UnitY())) * Quat(0, 1, 0, 0);
  pair.at_W.z() = 1000.0;
  ASSERT_TRUE(parallel_axes(pair));
  EXPECT_NEAR(parallel_axes(pair)->apart_mm, std::hypot(0.03 + 1e-5 * 995, 0.04), 1e-8);
  pair.length_mm = 1000.0;  // too far for that
  EXPECT_FALSE(parallel_axes(pair));
  pair.length_mm = 10.0;
  hole.position_grows = true;
  EXPECT_FALSE(parallel_axes(pair));
  hole.position_grows = false;
  pin.surface->inward = true;
  EXPECT_FALSE(parallel_axes(pair));
  pin.surface->inward = hole.surface->inward = false;
  ASSERT_TRUE(parallel_axes(pair));
  EXPECT_FALSE(parallel_axes(pair)->nested);
  pin.surface->kind = SurfaceKind::kPlane;
  EXPECT_FALSE(parallel_axes(pair));
  pin.surface.reset();
  EXPECT_FALSE(parallel_axes(pair));
}

}  // namespace
}  // namespace mortise
