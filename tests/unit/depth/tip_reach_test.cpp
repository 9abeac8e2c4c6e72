// Edges and corners of plane faces near a shaft: what is said to be apart is apart for the sharp
// bodies. The truth is found by supports of convex sets and shares no code with the engine.
#include <gtest/gtest.h>

#include "common/geometry/tips.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/overlap_case.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

using polyhedra::Polyhedron;

constexpr double kShaftRadius_mm = 3.0, kShaftHalf_mm = 5.0;
constexpr int kCoarse = 60, kFine = 600;  // steps to the nearest points

struct Shaft {
  SolidPtr solid;
  SurfaceBand band;
  double largest_radius_mm = kShaftRadius_mm;
};

Shaft shaft_of(double grows_mm, int facets) {
  Shaft shaft;
  shapes::Round round;
  round.radius_mm = kShaftRadius_mm;
  round.n = facets;
  round.z0_mm = -kShaftHalf_mm;
  round.z1_mm = kShaftHalf_mm;
  shaft.solid = shapes::solid(shapes::peg(round));
  shaft.band =
      shapes::cylinder_band(shaft.solid, kShaftRadius_mm, false, Interval{-grows_mm, grows_mm});
  shaft.largest_radius_mm += grows_mm;
  return shaft;
}

Vec3 farthest_of_shaft(const Shaft& shaft, const Vec3& n) {
  const Vec3 across(n.x(), n.y(), 0.0);
  const double length = across.norm();
  Vec3 x = length > 0.0 ? Vec3(shaft.largest_radius_mm / length * across) : Vec3::Zero();
  x.z() = n.z() > 0.0 ? kShaftHalf_mm : -kShaftHalf_mm;
  return x;
}

// Distance of the largest bodies, as a bracket: steps towards the nearest points (Frank and Wolfe).
Interval distance_of(const std::vector<Vec3>& corners_B, const Shaft& shaft, int steps) {
  const auto farthest = [&](const Vec3& n) {
    return *std::max_element(corners_B.begin(), corners_B.end(),
                             [&](const Vec3& a, const Vec3& b) { return n.dot(a) < n.dot(b); });
  };
  Vec3 way = corners_B.front();
  double lo = 0.0;
  for (int i = 0; i < steps && way.norm() > 1e-9; ++i) {
    const Vec3 n = way.normalized();
    const Vec3 to = farthest(-n) - farthest_of_shaft(shaft, n);
    lo = std::max(lo, n.dot(to));
    const Vec3 step = to - way;
    if (!(step.squaredNorm() > 0.0)) break;
    way += std::clamp(-way.dot(step) / step.squaredNorm(), 0.0, 1.0) * step;
  }
  return {lo, way.norm()};
}

// Is there a point that lies this deep in both? Looked for by projections onto one after the other.
bool share_a_point(const Polyhedron& body, const Pose& X_BA, const Shaft& shaft, Vec3 x) {
  constexpr double kDeep_mm = 2e-4;
  constexpr int kRounds = 3000;
  for (int round = 0; round < kRounds; ++round) {
    bool inside = true;
    const auto keep_below = [&](const Vec3& n, double above_mm) {
      if (above_mm <= 0.0) return;
      inside = false;
      x -= (above_mm + kDeep_mm) * n;
    };
    for (const polyhedra::HalfSpace& h : body.half_spaces) {
      const Vec3 n = X_BA.q * h.n;
      keep_below(n, n.dot(x - X_BA.p) - h.c - h.offset_mm.hi);
    }
    const Vec3 across(x.x(), x.y(), 0.0);
    keep_below(across.normalized(), across.norm() - shaft.largest_radius_mm);
    keep_below(Vec3::UnitZ(), x.z() - kShaftHalf_mm);
    keep_below(-Vec3::UnitZ(), -x.z() - kShaftHalf_mm);
    if (inside) return true;
  }
  return false;
}

std::vector<Vec3> largest_corners(const Polyhedron& body) {
  std::vector<polyhedra::HalfSpace> moved = body.half_spaces;
  for (polyhedra::HalfSpace& h : moved) h.c += h.offset_mm.hi;
  return polyhedra::corners_of(moved);
}

std::vector<Vec3> at(const Pose& X, std::vector<Vec3> points) {
  for (Vec3& point : points) point = X * point;
  return points;
}

struct TipTally {
  int pairs = 0, said_apart = 0, false_apart = 0, left_open = 0, apart = 0;
};

TipTally tried_tips(int pairs, std::uint64_t seed) {
  polyhedra::Random random(seed);
  TipTally tally;
  while (tally.pairs < pairs) {
    const Polyhedron body = polyhedra::random_convex(random);
    const Shaft shaft = shaft_of(polyhedra::between(random, 0.0, 0.03), 24);
    OverlapCase c{body.solid, shaft.solid, body.band, shaft.band};
    c.refinement = Refinement::kDecided;
    c.X_WA.q = polyhedra::rotation(random);
    const Vec3 along = polyhedra::direction(random);
    const std::vector<Vec3> of_body = largest_corners(body);
    double in = 0.0, out = 25.0;
    for (int i = 0; i < 18; ++i) {
      c.X_WA.p = 0.5 * (in + out) * along;
      (distance_of(at(c.X_WA, of_body), shaft, kCoarse).lo > 1e-4 ? out : in) = 0.5 * (in + out);
    }
    c.X_WA.p = (0.5 * (in + out) + polyhedra::between(random, -0.05, 0.08)) * along;
    const std::vector<Vec3> corners = at(c.X_WA, of_body);
    const Interval apart_mm = distance_of(corners, shaft, kFine);
    bool meet = false;
    for (const Vec3& corner : corners) meet = meet || share_a_point(body, c.X_WA, shaft, corner);
    ++tally.pairs;
    const bool none = worst_class(overlap_of(c)) <= CollisionClass::kFake;
    tally.said_apart += none;
    tally.false_apart += none && meet;
    tally.apart += apart_mm.lo > 1e-3;
    tally.left_open += !none && apart_mm.lo > 1e-3;
  }
  return tally;
}

TEST(TipReach, NothingIsSaidToBeApartThatMeets) {
  const TipTally tally = tried_tips(test::effort(120), 20261125);
  EXPECT_EQ(tally.false_apart, 0);
  EXPECT_GT(tally.said_apart, tally.pairs / 4);
  EXPECT_LT(tally.left_open, tally.apart / 8);
}

// A blade of 20 degrees above the shaft: its edge travels 5.8 times as far as its faces.
TEST(TipReach, ABladeReachesAsFarAsItsEdgeTravels) {
  const double angle = 20.0 * std::numbers::pi / 180.0, offset_mm = 0.02;
  const double half = 2.0 * std::tan(0.5 * angle);
  TriangleMesh blade =
      shapes::prism({{0.0, 0.0}, {half, 2.0}, {-half, 2.0}}, {{0, 1, 2}}, -1.0, 1.0);
  OverlapCase c{shapes::solid(blade), nullptr};
  c.band_a = shapes::uniform_band({}, {-offset_mm, offset_mm}, DeviationGrade::kPlanar);
  const Shaft shaft = shaft_of(0.0, 24);
  c.b = shaft.solid;
  c.band_b = shaft.band;
  c.refinement = Refinement::kDecided;
  const double travel_mm = offset_mm / std::sin(0.5 * angle);
  for (const double gap_mm : {0.3 * travel_mm, 0.98 * travel_mm, 1.02 * travel_mm}) {
    // Its edge along the shaft, so that the tip points to the axis.
    c.X_WA.p = Vec3(0.0, kShaftRadius_mm + gap_mm, 0.0);
    EXPECT_EQ(worst_class(overlap_of(c)),
              gap_mm < travel_mm ? CollisionClass::kPotential : CollisionClass::kNone)
        << gap_mm;
  }
  // It travels forward, not to its sides.
  c.X_WA.q = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi - 0.5 * angle, Vec3::UnitZ()));
  c.X_WA.p = Vec3(0.0, kShaftRadius_mm + 0.5 * travel_mm, 0.0);
  EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kNone);
}

}  // namespace
}  // namespace mortise
