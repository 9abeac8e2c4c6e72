// Two triangles, any shape down to needles of aspect 1e12, near, touching and through one another:
// the distance from which every number of an answer comes, against long double.
#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/triangle_distance.h"
#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"

namespace mortise::stress {
namespace {

Triangle random_triangle(std::mt19937_64& random, double aspect) {
  const Vec3 at = random_vector(random, 1.0), along = random_vector(random, 1.0);
  const Vec3 across = along.cross(random_vector(random, 1.0)).normalized() * along.norm() / aspect;
  const double where = uniform(random, -0.2, 1.2);
  Triangle t = {at, Vec3(at + along), Vec3(at + where * along + across)};
  std::shuffle(t.begin(), t.end(), random);
  return t;
}

// A point of it: inside, on an edge, or a corner.
Vec3 point_on(std::mt19937_64& random, const Triangle& t) {
  double u = uniform(random, 0.0, 1.0), v = uniform(random, 0.0, 1.0 - u);
  if (random() % 3 == 0) v = 0.0;
  if (random() % 6 == 0) u = v = 0.0;
  return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
}

Corners corners_of(const Triangle& t) { return {point_of(t[0]), point_of(t[1]), point_of(t[2])}; }

// In units of 8 u times the largest coordinate.
double error_of(const Triangle& a, const Triangle& b, const TriangleDistance& d) {
  const Corners x = corners_of(a), y = corners_of(b);
  double extent = 0.0;
  for (int k = 0; k < 3; ++k) extent = std::max({extent, a[k].norm(), b[k].norm()});
  const Real truth = passes_through(x, y) ? 0 : distance_of(x, y).mm;
  Real worst = std::abs(truth - d.distance_mm);
  if (!d.crossing)
    worst =
        std::max({worst, distance_to(point_of(d.point_a), x), distance_to(point_of(d.point_b), y),
                  std::abs(norm(point_of(d.point_a) - point_of(d.point_b)) - d.distance_mm)});
  return static_cast<double>(worst) / (8.0 * kUnitRoundoff * extent);
}

TEST(Triangles, DistanceOfAnyShapes) {
  for (const double aspect : {1e0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12}) {
    char name[64];
    std::snprintf(name, sizeof name, "triangles, aspect to %.0e (in 8 u)", aspect);
    Sweep sweep(name);
    std::mt19937_64 random(150);
    int crossing = 0;
    for (int i = 0; i < test::effort(3000); ++i) {
      const auto shape = [&] { return std::pow(aspect, uniform(random, 0.0, 1.0)); };
      const Triangle a = random_triangle(random, i % 4 == 0 ? aspect : shape());
      Triangle b = random_triangle(random, shape());
      const double scale = std::pow(10.0, uniform(random, -3.0, 1.0));
      for (Vec3& p : b) p *= scale;
      const double gap = i % 3 == 0 ? 0.0 : std::pow(10.0, uniform(random, -17.0, 0.0));
      const Vec3 by = point_on(random, a) - point_on(random, b) + random_vector(random, gap);
      for (Vec3& p : b) p += by;
      TriangleDistance d;
      {
        const FloatGuard guard(name);
        d = i % 2 == 0 ? triangle_distance(a, b) : triangle_distance(b, a);
      }
      crossing += d.crossing;
      sweep.measured(i % 2 == 0 ? error_of(a, b, d) : error_of(b, a, d), 1.0,
                     "pair " + std::to_string(i));
    }
    EXPECT_GT(crossing, 100);
  }
}

}  // namespace
}  // namespace mortise::stress
