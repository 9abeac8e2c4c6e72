// Ten million increments composed: the pose drifts by rounding only, the orientation stays unit.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"

namespace mortise::stress {
namespace {

// A pose in long double, composed by quaternions of its own.
struct Long {
  Real w = 1, x = 0, y = 0, z = 0;
  Point p;
};

Long long_of(const Pose& X) { return {X.q.w(), X.q.x(), X.q.y(), X.q.z(), point_of(X.p)}; }

// The rotation vector's own meaning, not the library's quaternion of it.
Long increment(const Vec3& w, const Vec3& v) {
  const Point turn = point_of(w);
  const Real angle = norm(turn), half = angle / 2;
  const Real s = angle > 0 ? std::sin(half) / angle : Real(0.5);
  return {std::cos(half), s * turn.x, s * turn.y, s * turn.z, point_of(v)};
}

Long composed(const Long& d, const Long& X) {
  const Placement turn = [&] {
    const Real s = 2 / (d.w * d.w + d.x * d.x + d.y * d.y + d.z * d.z);
    Placement P;
    P.row[0] = {1 - s * (d.y * d.y + d.z * d.z), s * (d.x * d.y - d.w * d.z),
                s * (d.x * d.z + d.w * d.y)};
    P.row[1] = {s * (d.x * d.y + d.w * d.z), 1 - s * (d.x * d.x + d.z * d.z),
                s * (d.y * d.z - d.w * d.x)};
    P.row[2] = {s * (d.x * d.z - d.w * d.y), s * (d.y * d.z + d.w * d.x),
                1 - s * (d.x * d.x + d.y * d.y)};
    return P;
  }();
  Long r;
  r.w = d.w * X.w - d.x * X.x - d.y * X.y - d.z * X.z;
  r.x = d.w * X.x + d.x * X.w + d.y * X.z - d.z * X.y;
  r.y = d.w * X.y - d.x * X.z + d.y * X.w + d.z * X.x;
  r.z = d.w * X.z + d.x * X.y - d.y * X.x + d.z * X.w;
  r.p = turn.turned(X.p) + d.p;
  return r;
}

double angle_between(const Pose& X, const Long& Y) {
  const Real n = std::sqrt(Y.w * Y.w + Y.x * Y.x + Y.y * Y.y + Y.z * Y.z);
  const Real dot_q = (X.q.w() * Y.w + X.q.x() * Y.x + X.q.y() * Y.y + X.q.z() * Y.z) / n;
  const Real side = dot_q < 0 ? -1 : 1;
  const Real dw = X.q.w() - side * Y.w / n, dx = X.q.x() - side * Y.x / n,
             dy = X.q.y() - side * Y.y / n, dz = X.q.z() - side * Y.z / n;
  return 2 * static_cast<double>(std::sqrt(dw * dw + dx * dx + dy * dy + dz * dz));
}

// Steps of a designer's hand: some turn, some shift, anywhere within a metre.
void compose(int steps, double largest_rad, const char* name) {
  Sweep sweep(name);
  std::mt19937_64 random(700);
  Pose X;
  Long twin = long_of(X);
  double worst_length = 0.0;
  {
    const FloatGuard guard(name);
    for (int i = 0; i < steps; ++i) {
      const Vec3 w = random_turn(random, largest_rad);
      // Back towards the origin when a metre away: the drift, not the way, is looked at.
      const Vec3 v = random_vector(random, 1.0) -
                     (X.p.norm() > 1000.0 ? Vec3(1e-3 * X.p) : Vec3::Zero().eval());
      X = Pose{rotation_exp(w), v} * X;
      twin = composed(increment(w, v), twin);
      worst_length = std::max(worst_length, std::abs(X.q.coeffs().norm() - 1.0));
    }
  }
  // Each step rounds an orientation by a few ulp; they add up like a random walk, at worst in line.
  const double steps_d = steps;
  const double turn_bound = 8.0 * kUnitRoundoff * std::sqrt(steps_d) + 4e-16;
  const double turn_error = angle_between(X, twin);
  const double place_error = static_cast<double>(norm(point_of(X.p) - twin.p));
  std::printf("%s: %d increments, orientation off by %.2g rad, place by %.2g mm, |q| - 1 by %.2g\n",
              name, steps, turn_error, place_error, worst_length);
  EXPECT_LE(turn_error, turn_bound);
  EXPECT_LE(worst_length, 4.5e-16);
  sweep.measured(place_error, 1000.0 * steps_d * kUnitRoundoff, "all increments");
  sweep.measured(turn_error * 1000.0, 1000.0 * steps_d * kUnitRoundoff, "orientation at a metre");
}

TEST(Increments, ComposedAMillionTimes) {
  // 5e5 twice in the short form, 1e7 in all in the soak.
  const int steps = test::effort(250'000);
  compose(steps, 0.1, "increments composed, up to 0.1 rad");
  compose(steps, std::numbers::pi, "increments composed, up to pi");
  compose(2 * steps, 1e-7, "increments composed, up to 1e-7 rad");
}

// v and w of a motion are what the two poses mean.
TEST(Increments, RotationVectorOfAMotion) {
  Sweep sweep("rotation vector against long double");
  std::mt19937_64 random(701);
  for (int i = 0; i < test::effort(20'000); ++i) {
    const double largest[] = {1e-300, 1e-12, 1e-7, 1e-3, 1.0, std::numbers::pi};
    const Vec3 w = random_turn(random, largest[i % 6]);
    const Quat q0 = rotation_exp(random_turn(random, std::numbers::pi));
    const Quat q1 = (rotation_exp(w) * q0).normalized();
    Motion m;
    {
      const FloatGuard guard("linear_motion " + std::to_string(i));
      m = linear_motion({q0, Vec3::Zero()}, {q1, Vec3::Zero()}, Vec3::Zero());
    }
    const Point truth = turn_between(q0, q1);
    const Point found = point_of(m.w_W);
    // At half a turn both signs are right.
    const Real error = std::min(norm(found - truth), norm(found + truth));
    if (norm(truth) < Real(3.14)) {
      EXPECT_LE(norm(found - truth), Real(1e-14)) << i;
    }
    sweep.measured(static_cast<double>(error), 1e-14, "motion " + std::to_string(i));
  }
}

// The path between the ends, at any time, for both kinds, the reference point far away or not.
TEST(Increments, PathAgainstLongDouble) {
  Sweep sweep("path against long double");
  for (int i = 0; i < test::effort(3000); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(710'000 + i));
    const double largest[] = {0.0, 1e-9, 1e-3, 1.0, std::numbers::pi};
    const double reach = std::pow(10.0, uniform(random, -3.0, 7.0));
    const Pose X0{rotation_exp(random_turn(random, 3.0)), random_vector(random, reach)};
    const Pose X1{(rotation_exp(random_turn(random, largest[i % 5])) * X0.q).normalized(),
                  X0.p + random_vector(random, 10.0)};
    const Vec3 reference = random_vector(random, i % 2 == 0 ? 1.0 : reach);
    const Motion m =
        i % 3 == 0 ? screw_motion(X0, X1, reference) : linear_motion(X0, X1, reference);
    const double extent = X0.p.norm() + X1.p.norm() + 2.0 * reference.norm() + 20.0;
    const double bound = 32.0 * kUnitRoundoff * extent;
    for (const double t : {0.0, 1e-9, 0.3, 0.5, 0.999, 1.0}) {
      const FloatGuard guard("pose_at");
      const Pose X = m.pose_at(t);
      const Placement truth = place_at(m, t);
      // A point within 10 mm of the part's frame.
      const Vec3 p = random_vector(random, 10.0);
      const Real error = norm(placement_of(X)(point_of(p)) - truth(point_of(p)));
      sweep.measured(static_cast<double>(error / extent), bound / extent,
                     "path " + std::to_string(i) + " at " + std::to_string(t));
    }
  }
}

}  // namespace
}  // namespace mortise::stress
