// The fast inner parts of recognition beside plain ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

#include "common/geometry/kernels/fit_sums.h"
#include "common/geometry/recognition/measure.h"
#include "common/geometry/recognition/recognition.h"
#include "common/geometry/recognition/region.h"
#include "common/geometry/recognition/surface_fit.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"
#include "tests/support/turned_part.h"

namespace mortise {
namespace {

constexpr SurfaceKind kCurved[] = {SurfaceKind::kCylinder, SurfaceKind::kCone, SurfaceKind::kSphere,
                                   SurfaceKind::kTorus};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  Vec3 vector() { return {between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)}; }
  std::mt19937_64& random() { return random_; }

 private:
  std::mt19937_64 random_;
};

Surface random_surface(SurfaceKind kind, Dice& dice) {
  Surface s;
  s.kind = kind;
  s.point = 50.0 * dice.vector();
  s.axis = (dice.vector() + Vec3(0.0, 0.0, 2.0)).normalized();
  s.radius_mm = dice.between(3.0, 30.0);
  if (kind == SurfaceKind::kTorus) s.tube_radius_mm = dice.between(0.2, 0.7) * s.radius_mm;
  if (kind == SurfaceKind::kCone) s.half_angle_rad = dice.between(0.2, 1.2);
  return s;
}

// A place at an angle about the axis and a share of the length or of the tube, moved off by noise.
Vec3 place_on(const Surface& s, double around, double share, double off) {
  const Vec3 u = s.axis.unitOrthogonal(), v = s.axis.cross(u);
  const Vec3 out = std::cos(around) * u + std::sin(around) * v;
  const double tilt = 1.5 * (share - 0.5);
  switch (s.kind) {
    case SurfaceKind::kCylinder:
      return s.point + 10.0 * share * s.axis + (s.radius_mm + off) * out;
    case SurfaceKind::kCone: {
      const double h = 10.0 + 10.0 * share;
      return s.point + h * s.axis + (h * std::tan(s.half_angle_rad) + off) * out;
    }
    case SurfaceKind::kSphere:
      return s.point + (s.radius_mm + off) * (std::cos(tilt) * out + std::sin(tilt) * s.axis);
    default:
      return s.point + s.radius_mm * out +
             (s.tube_radius_mm + off) * (std::cos(tilt) * out + std::sin(tilt) * s.axis);
  }
}

std::vector<Vec3> points_on(const Surface& s, int count, double noise_mm, Dice& dice) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(place_on(s, dice.between(0.0, 2.5), dice.between(0.0, 1.0),
                              dice.between(-noise_mm, noise_mm)));
  return points;
}

double cost_of(const Surface& s, const std::vector<Vec3>& points) {
  double cost = 0.0;
  for (const Vec3& x : points) cost += s.signed_distance_mm(x) * s.signed_distance_mm(x);
  return cost;
}

// The surface with one of its parameters changed a little; nothing beyond the last.
std::optional<Surface> nudged(Surface s, int parameter, double by) {
  if (parameter < 3) {
    s.point[parameter] += by;
  } else if (parameter < 6) {
    s.axis[parameter - 3] += 0.1 * by;
    s.axis.normalize();
  } else if (parameter == 6) {
    s.radius_mm += by;
  } else if (parameter == 7) {
    s.tube_radius_mm += by;
  } else if (parameter == 8) {
    s.half_angle_rad += 0.1 * by;
  } else {
    return std::nullopt;
  }
  return s;
}

// Counts that fill blocks of four points, and that do not.
TEST(SurfaceFit, RunsThroughExactPointsWhateverTheirCount) {
  Dice dice(5);
  for (int i = 0; i < test::effort(200); ++i)
    for (const SurfaceKind kind : kCurved) {
      const Surface truth = random_surface(kind, dice);
      const auto points = points_on(truth, 12 + i % 9, 0.0, dice);
      const Surface start = *nudged(*nudged(truth, i % 3, 1e-2), 6, 1e-2);
      const auto fit = fitted_surface(start, points);
      ASSERT_TRUE(fit) << i;
      EXPECT_LE(residual_of(*fit, points), 1e-9 * (truth.point.norm() + 100.0)) << i;
    }
}

TEST(SurfaceFit, NoSurfaceBesideItIsNearerToNoisyPoints) {
  Dice dice(6);
  for (int i = 0; i < test::effort(200); ++i)
    for (const SurfaceKind kind : kCurved) {
      const Surface truth = random_surface(kind, dice);
      const auto points = points_on(truth, 60 + i % 7, 1e-3, dice);
      const auto fit = fitted_surface(truth, points, 1e-12);
      ASSERT_TRUE(fit) << i;
      const double least = cost_of(*fit, points);
      EXPECT_LE(least, cost_of(truth, points)) << i;
      for (const double by : {-1e-4, 1e-4})
        for (int p = 0; const auto other = nudged(*fit, p, by); ++p)
          EXPECT_GE(cost_of(*other, points), least * (1.0 - 1e-6)) << i << " parameter " << p;
    }
}

TEST(SurfaceFit, GivesUpPointsThatAreFartherOffThanAsked) {
  Dice dice(7);
  const Surface truth = random_surface(SurfaceKind::kCylinder, dice);
  const auto points = points_on(truth, 40, 0.5, dice);
  EXPECT_TRUE(fitted_surface(truth, points, 1e-12));
  EXPECT_FALSE(fitted_surface(truth, points, 1e-12, 1e-3));
}

// Every kind, counts that fill blocks and that do not, sums that go to the end and that stop
// before.
TEST(FitSums, WideRegistersGiveTheSameBits) {
  const geometry::FitKernels* wide = geometry::wide_fit_sums();
  if (wide == nullptr) GTEST_SKIP() << "no wide registers on this machine";
  const geometry::FitKernels& plain = geometry::portable_fit_sums();
  Dice dice(14);
  for (int i = 0; i < test::effort(500); ++i) {
    geometry::FitModel m{};
    for (double* of : {m.p, m.a, m.u, m.v})
      for (int k = 0; k < 3; ++k) of[k] = dice.between(-1.0, 1.0);
    m.size = dice.between(0.1, 2.0);
    m.other = dice.between(0.05, 1.0);
    m.cosine = std::cos(m.other);
    m.sine = std::sin(m.other);
    const std::size_t count = 1 + static_cast<std::size_t>(dice.between(0.0, 70.0));
    std::vector<double> blocks((count + 3) / 4 * 12, 0.0);
    for (double& x : blocks) x = dice.between(-1.0, 1.0);
    const double limit = i % 3 == 0 ? dice.between(0.0, 10.0) : 1e300;
    for (const auto& [fast, slow, n] : {std::tuple{wide->cylinder, plain.cylinder, 5},
                                        {wide->cone, plain.cone, 6},
                                        {wide->sphere, plain.sphere, 4},
                                        {wide->torus, plain.torus, 7}}) {
      geometry::FitPass a, b;
      fast(m, blocks.data(), count, limit, a);
      slow(m, blocks.data(), count, limit, b);
      EXPECT_EQ(a.cost, b.cost) << i;
      for (int k = 0; k < n; ++k) EXPECT_EQ(a.gradient[k], b.gradient[k]) << i << " of " << n;
      for (int k = 0; k < n * (n + 1) / 2; ++k)
        EXPECT_EQ(a.normal[k], b.normal[k]) << i << " of " << n;
    }
  }
}

// More corners than are kept at once, in an order in which kept ones are met again and in one in
// which they hardly are.
TEST(MeasureRegion, DoesNotDependOnTheOrderOfTheTriangles) {
  shapes::Chain outer, inner;
  inner.inward = true;
  outer.start(20.0, 0.0).line(20.0, 10.0).arc(15.0, 10.0, 1.2, 40);
  const double top = outer.points.back().z;
  inner.start(5.0, 0.0).line(5.0, top);
  const TriangleMesh mesh = shapes::turned_part(outer, inner, 96, 1.5 * kPi);
  Dice dice(8);
  std::set<bool> rows;
  for (const shapes::TurnedSurface& turned : outer.surfaces) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      bool on = true;
      for (int k = 0; k < 3; ++k)
        on &= std::fabs(turned.surface.signed_distance_mm(mesh.corner(t, k))) < 1e-9;
      if (on) triangles.push_back(t);
    }
    ASSERT_FALSE(triangles.empty());
    const RegionMeasure in_order = measure_region(mesh, turned.surface, triangles);
    EXPECT_EQ(in_order.along_mm, extent_along_mm(mesh, turned.surface, triangles));
    EXPECT_EQ(in_order.steps, 96U);
    EXPECT_EQ(lie_in_one_row(mesh, turned.surface, triangles), in_order.one_row);
    EXPECT_NEAR(in_order.arc_rad, 1.5 * kPi, 1e-9);
    std::shuffle(triangles.begin(), triangles.end(), dice.random());
    const RegionMeasure shuffled = measure_region(mesh, turned.surface, triangles);
    EXPECT_EQ(shuffled.along_mm, in_order.along_mm);
    EXPECT_EQ(shuffled.steps, in_order.steps);
    EXPECT_EQ(shuffled.arc_rad, in_order.arc_rad);
    EXPECT_EQ(shuffled.meridian_rad, in_order.meridian_rad);
    EXPECT_EQ(shuffled.one_row, in_order.one_row);
    rows.insert(in_order.one_row);
  }
  EXPECT_EQ(rows.size(), 2U);
}

// The short cut of growing beside the whole test: where edges are short for the least radius, the
// normals at the corners look alike.
TEST(LeastRadius, NormalsAtCornersThatAreNearTurnByLessThan45Degrees) {
  Dice dice(11);
  int near = 0;
  for (int i = 0; i < test::effort(20'000); ++i)
    for (const SurfaceKind kind : kCurved) {
      const Surface s = random_surface(kind, dice);
      const double around = dice.between(0.0, 2.0 * kPi), share = dice.between(-1.0, 3.0);
      const double wide = std::pow(10.0, dice.between(-2.0, 0.5));
      std::array<Vec3, 3> x;
      for (Vec3& corner : x)
        corner = place_on(s, around + wide * dice.between(-1.0, 1.0),
                          share + wide * dice.between(-1.0, 1.0), 0.0);
      const double longest2 = std::max(
          {(x[1] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm(), (x[0] - x[2]).squaredNorm()});
      const double radius = least_radius_mm(s, x[0], x[1], x[2]);
      if (!(longest2 < 0.5 * radius * radius)) continue;
      ++near;
      for (int k = 0; k < 3; ++k)
        EXPECT_GT(s.outward_normal(x[k]).dot(s.outward_normal(x[(k + 1) % 3])), std::sqrt(0.5))
            << i << " kind " << static_cast<int>(kind);
    }
  EXPECT_GT(near, test::effort(20'000));
}

// What is kept by triangle beside a plain list of balls, of which the last one with a triangle
// counts.
TEST(FlatBalls, HoldWhatAPlainListHolds) {
  constexpr std::uint32_t kTriangles = 12;
  Dice dice(13);
  const auto some = [&] {
    Region r;
    r.surface.kind = dice.between(0.0, 1.0) < 0.9 ? SurfaceKind::kSphere : SurfaceKind::kCylinder;
    r.share = dice.between(0.0, 1.0) < 0.5 ? 1e-6 : 2e-5;
    r.allowed_mm = std::pow(10.0, dice.between(-4.0, -3.0));
    const auto from = static_cast<std::uint32_t>(dice.between(0.0, kTriangles - 1.0));
    const auto count = static_cast<std::uint32_t>(dice.between(1.0, 6.0));
    for (std::uint32_t t = from; t < std::min(from + count, kTriangles); ++t)
      r.triangles.push_back(t);
    return r;
  };
  int held = 0;
  for (int i = 0; i < test::effort(300); ++i) {
    FlatBalls fast;
    std::vector<Region> plain;
    for (int k = 0; k < 6; ++k) {
      const Region start = some();
      std::set<const Region*> last;
      for (const std::uint32_t t : start.triangles) {
        const auto found = std::find_if(plain.rbegin(), plain.rend(), [&](const Region& ball) {
          return std::find(ball.triangles.begin(), ball.triangles.end(), t) != ball.triangles.end();
        });
        last.insert(found == plain.rend() ? nullptr : &*found);
      }
      const Region* ball = last.size() == 1 ? *last.begin() : nullptr;
      const bool holds = start.surface.kind == SurfaceKind::kSphere && ball != nullptr &&
                         ball->share == start.share && start.allowed_mm >= 0.25 * ball->allowed_mm;
      EXPECT_EQ(fast.hold(start.triangles, start), holds) << i;
      held += holds;
      plain.push_back(some());
      fast.keep(plain.back(), kTriangles);
    }
  }
  EXPECT_GT(held, test::effort(30));
}

// Corners off by more than the strictest share: seeds fail, are given up for a kind, and are tried
// again where corners may be farther off.
TEST(Recognition, NoisyCornersShowTheSurfacesOfTheExactPart) {
  shapes::Chain outer, inner;
  inner.inward = true;
  outer.start(20.0, 0.0).line(20.0, 12.0).line(26.0, 18.0).line(26.0, 30.0);
  inner.start(8.0, 0.0).line(8.0, 30.0);
  const TriangleMesh exact = shapes::turned_part(outer, inner, 64);
  for (const double noise_share : {0.0, 5e-6, 1e-4}) {
    TriangleMesh mesh = exact;
    Dice dice(9);
    for (Vec3& x : mesh.points_mm) {
      const double r = std::hypot(x.x(), x.y());
      x += noise_share * r * dice.between(-1.0, 1.0) * Vec3(x.x() / r, x.y() / r, 0.0);
    }
    const Recognition found = recognize_features(Solid(mesh), {.planes = false});
    std::vector<std::string> names;
    for (const Feature& f : found.features) names.push_back(f.name);
    EXPECT_EQ(names, (std::vector<std::string>{"bore_1", "shaft_1", "shaft_2", "cone_1"}))
        << noise_share;
    const Recognition again = recognize_features(Solid(mesh), {.planes = false});
    ASSERT_EQ(again.features.size(), found.features.size());
    for (std::size_t i = 0; i < found.features.size(); ++i) {
      EXPECT_EQ(again.features[i].triangles, found.features[i].triangles);
      EXPECT_EQ(again.features[i].residual_mm, found.features[i].residual_mm);
      EXPECT_EQ(again.features[i].surface.radius_mm, found.features[i].surface.radius_mm);
    }
  }
}

}  // namespace
}  // namespace mortise
