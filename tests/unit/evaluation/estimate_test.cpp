#include "common/evaluation/estimate.h"

#include <gtest/gtest.h>

#include "common/base/constants.h"
#include "common/evaluation/band.h"
#include "tests/support/numbers.h"
#include "tests/support/turned_part.h"

namespace mortise {
namespace {

using shapes::Chain;

// The estimate of the triangle whose middle lies nearest to x.
Interval estimate_at(const Solid& solid, const std::vector<Interval>& all, const Vec3& x) {
  std::size_t best = 0;
  double least = 1e300;
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    const TriangleMesh& m = solid.mesh();
    const double d = ((m.corner(t, 0) + m.corner(t, 1) + m.corner(t, 2)) / 3.0 - x).norm();
    if (d < least) least = d, best = t;
  }
  return all[best];
}

TEST(Estimate, OfAnEvenCylinderIsItsSagitta) {
  for (const int n : {12, 32, 512}) {
    const Solid solid(shapes::peg({.radius_mm = 10.0, .n = n}));
    const auto all = estimated_deviation_mm(solid);
    const double sagitta = 10.0 * (1.0 - std::cos(kPi / n));
    const Interval side = estimate_at(solid, all, Vec3(10, 0, 10));
    EXPECT_NEAR(side.hi, sagitta, 1e-9) << n;
    EXPECT_EQ(side.lo, 0.0);
    EXPECT_EQ(estimate_at(solid, all, Vec3(1, 0, 20)), Interval{}) << "the cap is flat";
  }
  const Solid solid(shapes::peg({.radius_mm = 10.0, .n = 32}));
  EXPECT_NEAR(estimate_at(solid, estimated_deviation_mm(solid), Vec3(10, 0, 10)).hi, 0.0481527,
              1e-7);
}

TEST(Estimate, OfABoreLiesInwardAndRowsDoNotCount) {
  const Solid solid(shapes::ring({.radius_mm = 10.0, .n = 32, .rows = 5}, 30.0));
  const auto all = estimated_deviation_mm(solid);
  const Interval bore = estimate_at(solid, all, Vec3(10, 0, 10));
  EXPECT_NEAR(bore.lo, -0.0481527, 1e-7);
  EXPECT_EQ(bore.hi, 0.0);
}

TEST(Estimate, OfFlatPartsIsNothing) {
  const Solid solid(shapes::box(Vec3(5, 6, 7), Vec3::Zero(), 3));
  for (const Interval& e : estimated_deviation_mm(solid)) EXPECT_EQ(e, Interval{});
  const Solid hexagon(shapes::peg({.radius_mm = 10.0, .n = 6}));
  for (const Interval& e : estimated_deviation_mm(hexagon)) EXPECT_EQ(e, Interval{});
}

TEST(Estimate, IsRoundedOutwardToPreferredNumbers) {
  EXPECT_EQ(coarsened({}), Interval{});
  const Interval c = coarsened({-0.01, 0.02});
  EXPECT_LE(c.lo, -0.015);
  EXPECT_GE(c.lo, -0.015 * 1.26);
  EXPECT_GE(c.hi, 0.03);
  EXPECT_LE(c.hi, 0.03 * 1.26);
}

// Turned parts of all four kinds: which share of facets does the estimate cover, and by how much?
TEST(Estimate, CoversTheTrueDeviationOfTurnedParts) {
  std::mt19937_64 random(7);
  int facets = 0, covered = 0, ample = 0, wrong_way = 0;
  double most = 0.0;
  for (int i = 0; i < 120; ++i) {
    const auto pick = [&](double lo, double hi) {
      return std::uniform_real_distribution<double>(lo, hi)(random);
    };
    const double R = std::exp(pick(std::log(1.5), std::log(250.0)));
    const int n = static_cast<int>(std::exp(pick(std::log(12.0), std::log(200.0))));
    const int rows = std::clamp(n / 4, 3, 24);
    Chain outer, inner;
    inner.inward = true;
    inner.start(0.2 * R, -2.0 * R).line(0.2 * R, 2.0 * R);
    switch (i % 4) {
      case 0:
        outer.start(R, -2.0 * R).line(R, 2.0 * R);
        break;
      case 1:
        outer.start(R, -2.0 * R).line(pick(0.4, 2.5) * R, 2.0 * R);
        break;
      case 2:  // a ball on a stem
        outer.start(0.5 * R, -2.0 * R).line(0.5 * R, -std::sqrt(0.75) * R);
        outer.arc(0.0, 0.0, kPi / 3.0, 2 * rows).line(0.5 * R, 2.0 * R);
        break;
      default:  // a bead: the outer half of a torus
        outer.start(R, -2.0 * R).line(R, -0.4 * R).arc(R, 0.0, 0.5 * kPi, 2 * rows);
        outer.line(R, 2.0 * R);
    }
    const Pose X = shapes::random_pose(random, R);
    const Solid solid(transformed(turned_part(outer, inner, n), X));
    const auto all = estimated_deviation_mm(solid);
    const shapes::TurnedSurface& main = outer.surfaces[outer.surfaces.size() / 2];
    const Surface surface = shapes::moved(main.surface, X);
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      const TriangleMesh& m = solid.mesh();
      bool on_it = true;
      for (int k = 0; k < 3; ++k)
        on_it = on_it && std::fabs(surface.signed_distance_mm(m.corner(t, k))) < 1e-9 * R;
      const Vec3 normal = (m.corner(t, 1) - m.corner(t, 0)).cross(m.corner(t, 2) - m.corner(t, 0));
      const Vec3 middle = (m.corner(t, 0) + m.corner(t, 1) + m.corner(t, 2)) / 3.0;
      if (!on_it || normal.normalized().dot(surface.outward_normal(middle)) < 0.8) continue;
      const Interval range = surface.signed_distance_range_mm(m.corner(t, 0), m.corner(t, 1),
                                                              m.corner(t, 2), 1e-5 * R);
      const double truth = -range.lo;
      ++facets;
      const double with_factor = kEstimatedDeviationFactor * all[t].hi;
      covered += with_factor >= truth - 2e-5 * R ? 1 : 0;
      ample += with_factor > 3.0 * truth + 1e-4 * R ? 1 : 0;
      wrong_way += all[t].lo < -1e-6 * R ? 1 : 0;
      if (truth > 1e-4 * R) most = std::max(most, with_factor / truth);
    }
  }
  std::printf("%d facets: %.3f %% covered, %.3f %% more than three times as much, at most %.2f\n",
              facets, 100.0 * covered / facets, 100.0 * ample / facets, most);
  EXPECT_GE(covered, 0.999 * facets);
  EXPECT_LE(ample, 0.02 * facets);
  EXPECT_EQ(wrong_way, 0);
}

TEST(Estimate, BecomesFewFacesOfABand) {
  const SolidPtr solid = shapes::solid(shapes::sphere(10.0, Vec3::Zero(), 32));
  BandInput input;
  input.solid = solid.get();
  input.estimate = true;
  const SurfaceBand band = build_band(input);
  EXPECT_FALSE(band.trivial);
  EXPECT_LE(band.faces.size(), 12U);
  for (std::uint32_t t = 0; t < solid->mesh().triangles.size(); ++t) {
    EXPECT_EQ(band.face_of(t).grade, DeviationGrade::kEstimated);
    EXPECT_GT(band.face_of(t).deviation_mm.hi, 0.0);
  }
  input.chord_error_mm = 0.1;  // declared: goes before the estimate
  for (const SurfaceBand::Face& face : build_band(input).faces)
    EXPECT_NE(face.grade, DeviationGrade::kEstimated);
}

}  // namespace
}  // namespace mortise
