// How far a turned cell comes beyond the wall of a hole, beside all points of its circles.
#include "common/depth/cells/cover_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/math/rotation.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}
double log_uniform(Random& random, double lo, double hi) {
  return std::exp(uniform(random, std::log(lo), std::log(hi)));
}

struct Drawn {
  ConvexCell shaft;
  VoidWall wall;
  Pose X;  // of the shaft in the frame of the wall
};

// A shaft, or a taper, in its bore, tilted and off its middle by little; or tilted by any angle.
Drawn any_fit(Random& random) {
  Drawn drawn;
  const double r = uniform(random, 2.0, 20.0), h = uniform(random, 5.0, 60.0);
  const double slope = random() % 3 == 0 ? uniform(random, 0.0, 0.3) : 0.0;
  const double across = 1.0 / std::hypot(1.0, slope);
  const MeridianLine lines[] = {{1.0, 0.0, 0.5 * h},
                                {-1.0, 0.0, 0.5 * h},
                                {-slope * across, across, (r + 0.5 * slope * h) * across}};
  drawn.shaft = *round_cell(Vec3::Zero(), Vec3::UnitZ(), lines);
  drawn.wall.r_mm = r + 0.5 * slope * h + uniform(random, -0.02, 0.05);
  drawn.wall.slope = slope;
  drawn.wall.cosine = across;
  if (random() % 2 == 0) drawn.wall.along_mm = {-uniform(random, 0.0, h), uniform(random, 0.0, h)};
  const double tilt =
      random() % 8 == 0 ? uniform(random, 0.0, 1.0) : log_uniform(random, 1e-6, 3e-3);
  const double around = uniform(random, 0.0, 6.0), off = log_uniform(random, 1e-5, 0.1);
  drawn.X.q = rotation_exp(uniform(random, 0.0, 6.0) * Vec3::UnitZ()) *
              rotation_exp(tilt * Vec3(std::cos(around), std::sin(around), 0.0));
  drawn.X.p = Vec3(off, 0.0, uniform(random, -0.3, 0.3) * h);
  return drawn;
}

// Of points of all circles between two that are given, all around.
double farthest_seen(const Drawn& drawn) {
  const ConvexCell& s = drawn.shaft;
  const VoidWall& wall = drawn.wall;
  double most = -1e9;
  constexpr int kHeights = 60, kAround = 2000;
  for (std::size_t k = 0; k + 1 < s.circles.size(); ++k)
    for (int i = 0; i <= kHeights; ++i) {
      const double share = double(i) / kHeights;
      const double z = s.circles[k].z_mm + share * (s.circles[k + 1].z_mm - s.circles[k].z_mm);
      const double r = s.circles[k].r_mm + share * (s.circles[k + 1].r_mm - s.circles[k].r_mm);
      for (int j = 0; j < kAround; ++j) {
        const double t = 2.0 * std::numbers::pi * j / kAround;
        const Vec3 x = drawn.X * Vec3(s.point + z * s.axis +
                                      r * (std::cos(t) * s.across[0] + std::sin(t) * s.across[1]));
        const Vec3 d = x - wall.point;
        const double height = d.dot(wall.axis);
        if (height < wall.along_mm.lo || height > wall.along_mm.hi) continue;
        most = std::max(most, wall.cosine * ((d - height * wall.axis).norm() - wall.r_mm -
                                             wall.slope * height));
      }
    }
  return most > 0.0 ? most / wall.cosine : most;
}

struct Asked {
  double most_mm;
  std::uint64_t work = 0;
};

Asked ask(const Drawn& drawn) {
  Asked asked{0.0};
  Chord chord;
  chord.X_KS[0] = drawn.X;
  asked.most_mm = beyond_wall_mm(drawn.shaft, chord, drawn.wall, drawn.wall.along_mm, -1e9, 1e9,
                                 asked.work, nullptr);
  return asked;
}

TEST(CoverBound, IsNeverBelowAPointOfTheCell) {
  Random random(81);
  int below = 0, close = 0, asked = 0;
  for (int i = 0; i < test::effort(300); ++i) {
    const Drawn drawn = any_fit(random);
    const double seen = farthest_seen(drawn), said = ask(drawn).most_mm;
    if (seen == -1e9) continue;
    ++asked;
    below += said < seen - 1e-9;
    close += said < seen + 0.02;
  }
  EXPECT_EQ(below, 0) << "of " << asked;
  EXPECT_GT(close, asked * 9 / 10);
}

// Where a shaft stands nearly in the middle of its bore the whole circumference is nearly as far
// out: sectors need not be short.
TEST(CoverBound, OfAShaftInItsBoreNeedsFewSectors) {
  Random random(82);
  std::uint64_t most = 0;
  for (int i = 0; i < 400; ++i) {
    Drawn drawn = any_fit(random);
    drawn.X.p.x() = log_uniform(random, 1e-5, 1e-3);
    drawn.X.q = rotation_exp(log_uniform(random, 1e-5, 1e-3) * Vec3::UnitX());
    most = std::max(most, ask(drawn).work);
  }
  EXPECT_LE(most, 60u);
}

Vec3 any_direction(Random& random) {
  return Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)).normalized();
}

// A cone frustum, or a block with random corners cut off.
ConvexCell any_cell(Random& random) {
  const double h = uniform(random, 2.0, 20.0), r = uniform(random, 2.0, 20.0);
  if (random() % 2 == 0) {
    const double slope = uniform(random, 0.0, 0.5), across = 1.0 / std::hypot(1.0, slope);
    const MeridianLine lines[] = {
        {1.0, 0.0, h}, {-1.0, 0.0, h}, {-slope * across, across, (r + slope * h) * across}};
    return *round_cell(Vec3::Zero(), any_direction(random), lines);
  }
  std::vector<HalfSpace> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) planes.push_back({side * Vec3::Unit(axis), h});
  for (int i = 0; i < 4; ++i) planes.push_back({any_direction(random), h + uniform(random, 0, 3)});
  return *polytope_cell(planes);
}

// Between both ends of the span, by support functions at many times of it.
TEST(CoverBound, HoldsAllAlongADirectionThatTurns) {
  Random random(83);
  int below = 0, in_between = 0, asked = 0;
  for (int i = 0; i < test::effort(2000); ++i) {
    const ConvexCell s = any_cell(random), k = any_cell(random);
    Chord chord;
    chord.ends = 2;
    chord.spread_mm = random() % 2 == 0 ? 0.0 : uniform(random, 0.0, 1e-2);
    Vec3 n[2] = {any_direction(random), Vec3::Zero()};
    n[1] = rotation_exp(log_uniform(random, 1e-4, 1.0) * any_direction(random)) * n[0];
    chord.X_KS[0] = {rotation_exp(3.0 * any_direction(random)), 30.0 * n[0]};
    chord.X_KS[1] = {
        rotation_exp(log_uniform(random, 1e-4, 1.0) * any_direction(random)) * chord.X_KS[0].q,
        30.0 * n[1]};
    const double bound = beyond_turning_mm(s, k, chord, n);
    double most = -kInfinity, at_ends = -kInfinity;
    constexpr int kTimes = 50;
    for (int j = 0; j <= kTimes; ++j) {
      const double t = double(j) / kTimes;
      const Vec3 along = (1.0 - t) * n[0] + t * n[1];
      const Vec3 along_S = (1.0 - t) * (chord.X_KS[0].q.conjugate() * along) +
                           t * (chord.X_KS[1].q.conjugate() * along);
      const Vec3 origin = (1.0 - t) * chord.X_KS[0].p + t * chord.X_KS[1].p;
      const double deep_mm =
          (k.support_mm(along) + s.support_mm(-along_S) - along.dot(origin)) / along.norm() +
          chord.spread_mm;
      most = std::max(most, deep_mm);
      if (j == 0 || j == kTimes) at_ends = std::max(at_ends, deep_mm);
    }
    ++asked;
    below += bound < most - 1e-9;
    in_between += most > at_ends + 1e-6;
  }
  EXPECT_EQ(below, 0) << "of " << asked;
  EXPECT_GT(in_between, asked / 8);
}

}  // namespace
}  // namespace mortise
