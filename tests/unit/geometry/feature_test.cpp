#include "common/geometry/feature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/math/pose.h"
#include "common/math/rotation.h"
#include "tests/support/numbers.h"

namespace mortise {
namespace {

// A point of the true surface at two parameters, about z with `point` at the origin: how the slow
// twin below knows the surface, by formula instead of by distance.
Vec3 point_of(const Surface& s, double u, double v) {
  const Vec3 round(std::cos(u), std::sin(u), 0.0);
  switch (s.kind) {
    case SurfaceKind::kPlane:
      return {u, v, 0.0};
    case SurfaceKind::kCylinder:
      return s.radius_mm * round + v * Vec3::UnitZ();
    case SurfaceKind::kCone:
      return v * (std::sin(s.half_angle_rad) * round + std::cos(s.half_angle_rad) * Vec3::UnitZ());
    case SurfaceKind::kSphere:
      return s.radius_mm * (std::cos(v) * round + std::sin(v) * Vec3::UnitZ());
    case SurfaceKind::kTorus:
      return (s.radius_mm + s.tube_radius_mm * std::cos(v)) * round +
             s.tube_radius_mm * std::sin(v) * Vec3::UnitZ();
    case SurfaceKind::kUnknown:
      break;
  }
  return Vec3::Zero();
}

struct Range {
  double u_lo, u_hi, v_lo, v_hi;
};
Range range_of(const Surface& s) {
  switch (s.kind) {
    case SurfaceKind::kPlane:
      return {-8, 8, -8, 8};
    case SurfaceKind::kCylinder:
      return {-kPi, kPi, -8, 8};
    case SurfaceKind::kCone:
      return {-kPi, kPi, 0, 12};
    default:
      return {-kPi, kPi, -kPi, kPi};
  }
}

// Nearest distance by a grid that closes in; about 1e-7 at the end.
double distance_by_sampling(const Surface& s, const Vec3& x) {
  Range r = range_of(s);
  const Range whole = r;
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 16; ++round) {
    constexpr int kGrid = 40;
    double best_u = 0, best_v = 0;
    best = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kGrid; ++i)
      for (int j = 0; j <= kGrid; ++j) {
        const double u = r.u_lo + (r.u_hi - r.u_lo) * i / kGrid;
        const double v = r.v_lo + (r.v_hi - r.v_lo) * j / kGrid;
        const double d = (point_of(s, u, v) - x).norm();
        if (d < best) best = d, best_u = u, best_v = v;
      }
    const double du = (r.u_hi - r.u_lo) / 8, dv = (r.v_hi - r.v_lo) / 8;
    r = {best_u - du, best_u + du, best_v - dv, best_v + dv};
    if (s.kind == SurfaceKind::kCone) r.v_lo = std::max(r.v_lo, whole.v_lo);
  }
  return best;
}

std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  for (const auto kind : {SurfaceKind::kPlane, SurfaceKind::kCylinder, SurfaceKind::kCone,
                          SurfaceKind::kSphere, SurfaceKind::kTorus})
    for (const bool inward : {false, true}) {
      Surface s;
      s.kind = kind;
      s.radius_mm = 4.0;
      s.tube_radius_mm = 1.5;
      s.half_angle_rad = 0.4;
      s.inward = inward;
      all.push_back(s);
    }
  return all;
}

// Is x inside the material, told from the definition?
bool in_material(const Surface& s, const Vec3& x) {
  const double r = std::hypot(x.x(), x.y());
  bool within = false;
  switch (s.kind) {
    case SurfaceKind::kPlane:
      return x.z() < 0.0;
    case SurfaceKind::kCylinder:
      within = r < s.radius_mm;
      break;
    case SurfaceKind::kCone:
      within = x.z() > 0.0 && r < x.z() * std::tan(s.half_angle_rad);
      break;
    case SurfaceKind::kSphere:
      within = x.norm() < s.radius_mm;
      break;
    default:
      within = std::hypot(r - s.radius_mm, x.z()) < s.tube_radius_mm;
  }
  return within != s.inward;
}

TEST(Feature, DistanceAgreesWithSamplingOnBothSidesAndUnderRigidMotion) {
  std::mt19937 random(20240611);
  std::uniform_real_distribution<double> coordinate(-6, 6);
  for (const Surface& s : surfaces()) {
    for (int i = 0; i < 12; ++i) {
      const Vec3 x(coordinate(random), coordinate(random), coordinate(random));
      const double expected = distance_by_sampling(s, x) * (in_material(s, x) ? -1.0 : 1.0);
      EXPECT_NEAR(s.signed_distance_mm(x), expected, 2e-6)
          << static_cast<int>(s.kind) << (s.inward ? " inward" : "");
      Surface moved = s;
      const Pose X{rotation_exp(Vec3(coordinate(random), coordinate(random), 1) * 0.3),
                   Vec3(1000, -200, coordinate(random))};
      moved.point = X * s.point;
      moved.axis = X.q * s.axis;
      EXPECT_NEAR(moved.signed_distance_mm(X * x), s.signed_distance_mm(x), 1e-10);
    }
  }
}

TEST(Feature, NormalIsTheSlopeOfTheDistanceAndPointsOut) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-6, 6);
  for (const Surface& s : surfaces())
    for (int i = 0; i < 20; ++i) {
      const Vec3 x(coordinate(random), coordinate(random), coordinate(random));
      const Vec3 n = s.outward_normal(x);
      EXPECT_NEAR(n.norm(), 1.0, 1e-12);
      constexpr double kStep = 1e-6;
      for (int k = 0; k < 3; ++k) {
        const Vec3 step = kStep * Vec3::Unit(k);
        const double slope =
            (s.signed_distance_mm(x + step) - s.signed_distance_mm(x - step)) / (2 * kStep);
        EXPECT_NEAR(n[k], slope, 2e-5) << static_cast<int>(s.kind) << " at " << x.transpose();
      }
      // From any point, its distance along the normal leads to the surface.
      EXPECT_NEAR(s.signed_distance_mm(x - s.signed_distance_mm(x) * n), 0.0, 1e-9);
    }
}

TEST(Feature, NormalExistsOnTheAxisAndAtTheCentre) {
  for (const Surface& s : surfaces()) EXPECT_NEAR(s.outward_normal(s.point).norm(), 1.0, 1e-12);
}

TEST(Feature, CurvatureBounds) {
  Surface s = surfaces()[2];  // cylinder
  EXPECT_DOUBLE_EQ(s.curvature_bound(Vec3(1, 0, 0)), 0.25);
  s.kind = SurfaceKind::kPlane;
  EXPECT_EQ(s.curvature_bound(Vec3(1, 0, 0)), 0.0);
  s.kind = SurfaceKind::kTorus;
  EXPECT_DOUBLE_EQ(s.curvature_bound(Vec3::Zero()), 1.0 / 1.5);
  // Cone: the normal curvature across a generator at distance v from the apex is 1/(v tan(a)).
  s.kind = SurfaceKind::kCone;
  EXPECT_NEAR(s.curvature_bound(point_of(s, 0.3, 5.0)), 1.0 / (5.0 * std::tan(0.4)), 1e-12);
}

TEST(Feature, RangeOverATriangleHoldsEveryPointAndIsTight) {
  std::mt19937 random(99);
  std::uniform_real_distribution<double> coordinate(-6, 6), unit(0, 1);
  for (const Surface& s : surfaces())
    for (int i = 0; i < 25; ++i) {
      const auto any = [&] {
        return Vec3(coordinate(random), coordinate(random), coordinate(random));
      };
      const Vec3 a = any(), b = any(), c = i % 2 ? any() : Vec3(a + 1e-3 * any());
      const Interval range = s.signed_distance_range_mm(a, b, c, 1e-4);
      double lo = 1e9, hi = -1e9;
      for (int k = 0; k < 4000; ++k) {
        double u = unit(random), v = unit(random);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const double d = s.signed_distance_mm(a + u * (b - a) + v * (c - a));
        lo = std::min(lo, d), hi = std::max(hi, d);
        ASSERT_GE(d, range.lo - 1e-12);
        ASSERT_LE(d, range.hi + 1e-12);
      }
      if (s.kind == SurfaceKind::kTorus) continue;  // documented to be wide
      EXPECT_LT(lo - range.lo, 0.4) << static_cast<int>(s.kind);
      EXPECT_LT(range.hi - hi, 0.4) << static_cast<int>(s.kind);
    }
}

TEST(Feature, RangeOverAFacetIsItsSagitta) {
  Surface s;
  s.kind = SurfaceKind::kCylinder;
  s.radius_mm = 10.0;
  for (const auto& [n, sagitta] :
       {std::pair{16, 0.192147196}, {32, 0.048152733}, {64, 0.012045438}, {512, 0.000188247}}) {
    const double a = 2 * kPi / n;
    const Vec3 p(10, 0, 0), q(10 * std::cos(a), 10 * std::sin(a), 0);
    const Interval range = s.signed_distance_range_mm(p, q, q + Vec3(0, 0, 100));
    EXPECT_NEAR(range.lo, -sagitta, 2e-7);
    EXPECT_NEAR(range.hi, 0.0, 1e-12);
  }
}

// Of a cone in closed form: a facet between two generators is deepest in the middle of its wide
// end, a triangle across the axis on it.
TEST(Surface, TrianglesOfACone) {
  Surface s;
  s.kind = SurfaceKind::kCone;
  s.half_angle_rad = 0.7;
  const double r = 4.0, z = r / std::tan(0.7), a = 0.35;
  const Vec3 p(r, 0, z), q(r * std::cos(a), r * std::sin(a), z);
  const Interval facet = s.signed_distance_range_mm(p, q, 0.5 * q);
  EXPECT_NEAR(facet.lo, -r * (1.0 - std::cos(0.5 * a)) * std::cos(0.7), 1e-12);
  EXPECT_NEAR(facet.hi, 0.0, 1e-12);
  const Interval across = s.signed_distance_range_mm({3, 0, 9}, {-1, 2, 9}, {-1, -2, 9});
  EXPECT_NEAR(across.lo, -9.0 * std::sin(0.7), 1e-12);
  s.inward = true;
  EXPECT_NEAR(s.signed_distance_range_mm(p, q, 0.5 * q).hi, -facet.lo, 1e-12);
}

// In front of the apex, against dense samples: no wider than these leave between them.
TEST(Surface, RangeOfAConeIsTight) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> near(-3.0, 3.0);
  Surface s;
  s.kind = SurfaceKind::kCone;
  s.half_angle_rad = 0.5;
  for (int i = 0; i < 200; ++i) {
    const auto any = [&] { return Vec3(near(random), near(random), 14.0 + near(random)); };
    const Vec3 a = any(), b = any(), c = any();
    const Interval range = s.signed_distance_range_mm(a, b, c);
    double lo = 1e9;
    for (int u = 0; u <= 200; ++u)
      for (int v = 0; u + v <= 200; ++v)
        lo = std::min(lo, s.signed_distance_mm(a + (b - a) * (u / 200.0) + (c - a) * (v / 200.0)));
    ASSERT_LE(range.lo, lo + 1e-12) << i;
    ASSERT_GE(range.lo, lo - 0.03) << i;
  }
}

// A facet with corners on a sphere of 10 whose circle has radius 1 lies 0.050125629 below it.
TEST(Surface, FacetOfASphere) {
  Surface s;
  s.kind = SurfaceKind::kSphere;
  s.radius_mm = 10.0;
  const double h = std::sqrt(99.0);
  const Interval range = s.signed_distance_range_mm({1, 0, h}, {-0.5, std::sqrt(0.75), h},
                                                    {-0.5, -std::sqrt(0.75), h});
  EXPECT_NEAR(range.lo, -0.050125629, 1e-9);
  EXPECT_NEAR(range.hi, 0.0, 1e-14);
}

// Inside the hole of a torus the distance bends sharply around the axis.
TEST(Surface, RangeHoldsNearTheAxisOfATorus) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> near(-1.5, 1.5);
  Surface s;
  s.kind = SurfaceKind::kTorus;
  s.radius_mm = 4.0;
  s.tube_radius_mm = 1.5;
  for (int i = 0; i < 300; ++i) {
    const auto any = [&] { return Vec3(near(random), near(random), 2.0 * near(random)); };
    const Vec3 a = any(), b = a + 0.3 * any(), c = a + 0.3 * any();
    const Interval range = s.signed_distance_range_mm(a, b, c, 1e-6);
    for (int u = 0; u <= 30; ++u)
      for (int v = 0; u + v <= 30; ++v) {
        const double d = s.signed_distance_mm(a + (b - a) * u / 30.0 + (c - a) * v / 30.0);
        ASSERT_GE(d, range.lo - 1e-12) << i;
        ASSERT_LE(d, range.hi + 1e-12) << i;
      }
  }
}

// The exact largest distance decides: just above it the answer is yes, just below it is no.
TEST(Surface, StaysBelowInKnownCases) {
  Surface bore;
  bore.kind = SurfaceKind::kCylinder;
  bore.radius_mm = 10.0;
  bore.inward = true;
  const double a = 2.0 * kPi / 32;
  const Vec3 p(10, 0, 0), q(10 * std::cos(a), 10 * std::sin(a), 0), r = q + Vec3(0, 0, 50);
  const double sagitta = 10.0 * (1.0 - std::cos(kPi / 32));
  EXPECT_TRUE(bore.stays_below_mm(p, q, r, sagitta + 1e-6));
  EXPECT_FALSE(bore.stays_below_mm(p, q, r, sagitta - 1e-6));
  bore.inward = false;  // the same facet of a shaft lies inside
  EXPECT_TRUE(bore.stays_below_mm(p, q, r, 1e-12));
  EXPECT_FALSE(bore.stays_below_mm(p, q, 1.1 * r, 0.5));  // a corner is out
  Surface socket;
  socket.kind = SurfaceKind::kSphere;
  socket.radius_mm = 10.0;
  socket.inward = true;
  const double h = std::sqrt(99.0);  // a facet on a circle of radius 1
  const Vec3 u(1, 0, h), v(-0.5, std::sqrt(0.75), h), w(-0.5, -std::sqrt(0.75), h);
  EXPECT_TRUE(socket.stays_below_mm(u, v, w, 10.0 - h + 1e-6));
  EXPECT_FALSE(socket.stays_below_mm(u, v, w, 10.0 - h - 1e-6));
  Surface plane;
  plane.kind = SurfaceKind::kPlane;
  EXPECT_TRUE(plane.stays_below_mm({0, 0, 1}, {1, 0, 2}, {0, 1, 3}, 3.0));
  EXPECT_FALSE(plane.stays_below_mm({0, 0, 1}, {1, 0, 2}, {0, 1, 3}, 2.999));
}

// Against dense sampling: never yes where a sample is above the limit; yes where the bracket of the
// range is clear of it. What the tally counts shows up when a limit is planted 5 um off.
struct BelowTally {
  int wrong_yes = 0, wrong_no = 0, yes = 0, no = 0;
};

BelowTally play_below(double planted_mm) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> coordinate(-6, 6), unit(0, 1);
  BelowTally tally;
  for (const Surface& s : surfaces())
    for (int i = 0; i < 120; ++i) {
      const auto any = [&] {
        return Vec3(coordinate(random), coordinate(random), coordinate(random));
      };
      const Vec3 a = any(), size = i % 3 == 0 ? Vec3(1, 1, 1) : Vec3(0.05, 0.05, 0.05);
      const Vec3 b = a + size.cwiseProduct(any()), c = a + size.cwiseProduct(any());
      double most = -1e9;
      constexpr int kGrid = 60;
      for (int u = 0; u <= kGrid; ++u)
        for (int v = 0; u + v <= kGrid; ++v)
          most =
              std::max(most, s.signed_distance_mm(a + (b - a) * u / kGrid + (c - a) * v / kGrid));
      // Limits just about the largest distance are the hard ones.
      const double limit = most + (i % 2 ? 1e-3 : -1e-3);
      const bool below = s.stays_below_mm(a, b, c, limit + planted_mm);
      (below ? tally.yes : tally.no) += 1;
      tally.wrong_yes += below && most > limit + 1e-9;
      tally.wrong_no += !below && s.signed_distance_range_mm(a, b, c).hi < limit - 1e-5;
    }
  return tally;
}

TEST(Surface, StaysBelowAgreesWithDenseSampling) {
  const BelowTally tally = play_below(0.0);
  EXPECT_EQ(tally.wrong_yes, 0);
  EXPECT_EQ(tally.wrong_no, 0);
  EXPECT_GT(tally.yes, 200);
  EXPECT_GT(tally.no, 200);
}

TEST(Surface, StaysBelowWithALimitPlanted5MicrometresOffIsSeen) {
  EXPECT_GT(play_below(5e-3).wrong_yes, 100);
  EXPECT_GT(play_below(-5e-3).wrong_no, 100);
}

}  // namespace
}  // namespace mortise
