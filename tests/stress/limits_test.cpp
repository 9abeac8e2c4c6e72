// Passing by within rounding, half turns, walls thinner than the accuracy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

std::string label(const char* what, double by, int i) {
  return std::string(what) + " " + std::to_string(by) + " (" + std::to_string(by * 1e12) +
         "e-12), case " + std::to_string(i);
}

const double kClearances[] = {1e-12, -1e-12, 0.0,  1e-9,  -1e-9, 1e-7,
                              -1e-7, 2e-6,   1e-5, -1e-5, 1e-15, -1e-15};

// A cube over a cube: face past face, face past edge, edge past edge; the scene turned anyhow.
TEST(Grazing, CubesPastEachOther) {
  Sweep sweep("grazing: cubes");
  std::mt19937_64 random(301);
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  const Pose stands[] = {{}, turn({kPi / 4, 0, 0}), turn({0, kPi / 4, 0})};
  const double tops[] = {0.5, std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};
  int i = 0;
  for (int round = 0; round < test::effort(2); ++round)
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        for (const double clearance : kClearances) {
          Case c;
          c.a = c.b = cube;
          const double height = tops[x] + tops[y] + clearance;
          const double across = uniform(random, 0.05, 0.3);  // edges along the way are met, too
          const Vec3 from(-3, across, height), to(3, -across, height);
          c.motion_a = linear_motion({stands[x].q, from}, {stands[x].q, to}, Vec3::Zero());
          c.motion_b = still_motion(stands[y]);
          const auto flat = sweep.ask(c, label("clearance", clearance, i)).state;
          if (std::abs(clearance) <= 1e-7) {
            EXPECT_EQ(flat, ContactState::kContact) << clearance;
          }
          if (clearance > c.accuracy_mm) {
            EXPECT_EQ(flat, ContactState::kFree) << clearance;
          }
          const Pose G{rotation_exp(random_turn(random, kPi)), random_vector(random, 5.0)};
          sweep.ask(moved(c, G), label("turned scene, clearance", clearance, i++));
        }
}

// Corner past corner of convex shapes along any direction, at the clearance along a normal across.
TEST(Grazing, CornersOfConvexShapes) {
  Sweep sweep("grazing: corners");
  for (int i = 0; i < test::effort(60); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(310'000 + i));
    Case c;
    c.a = random_shape(random, 1);
    c.b = random_shape(random, 1);
    const Vec3 along = random_turn(random, 1.0).normalized();
    const Vec3 across = along.cross(random_turn(random, 1.0)).normalized();
    const auto farthest = [](const Solid& solid, const Vec3& n) {
      Vec3 best = solid.mesh().points_mm[0];
      for (const Vec3& p : solid.mesh().points_mm)
        if (n.dot(p) > n.dot(best)) best = p;
      return best;
    };
    const double clearance = kClearances[i % 12];
    const Vec3 meet = farthest(*c.b, across) - farthest(*c.a, -across) + clearance * across;
    c.motion_a = slide(meet - 5 * along, meet + 4 * along);
    c.ask_fcl = false;  // its floor is reached half way
    const auto state = sweep.ask(c, label("corner clearance", clearance, i)).state;
    if (clearance > c.accuracy_mm) {
      EXPECT_EQ(state, ContactState::kFree);
    }
    if (std::abs(clearance) <= 1e-9) {
      EXPECT_EQ(state, ContactState::kContact);
    }
  }
}

TEST(HalfTurn, WithinRoundingOfPi) {
  Sweep sweep("rotation pi +- 1e-12");
  const double angles[] = {
      kPi,        kPi - 1e-12, kPi + 1e-12, std::nextafter(kPi, 0.0), std::nextafter(kPi, 4.0),
      kPi - 1e-9, kPi + 1e-9};
  for (int i = 0; i < test::effort(60); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(320'000 + i));
    for (const double angle : angles) {
      Case c = random_case(static_cast<std::uint64_t>(320'000 + i));
      const auto half = [&](const Motion& m) {
        const Vec3 axis =
            i % 3 == 0 ? Vec3(Vec3::Unit(i / 3 % 3)) : random_turn(random, 1.0).normalized();
        const Pose end{(rotation_exp(angle * axis) * m.X_W0.q).normalized(), m.X_W1.p};
        return i % 2 == 0 ? linear_motion(m.X_W0, end, m.reference_P)
                          : screw_motion(m.X_W0, end, m.reference_P);
      };
      c.motion_a = half(c.motion_a);
      if (i % 4 == 0) c.motion_b = half(c.motion_b);
      EXPECT_LE(c.motion_a.w_W.norm(), kPi * (1 + 4e-16));
      sweep.ask(c, label("angle", angle, i));
    }
  }
}

// Anything through a wall in one tick, however thin the wall and fast the part.
TEST(ThinWall, IsNeverPassed) {
  for (const double thick_mm : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0}) {
    char name[40];
    std::snprintf(name, sizeof name, "wall of %g mm", thick_mm);
    Sweep sweep(name);
    TriangleMesh mesh = box_mesh({thick_mm, 40, 40});
    if (thick_mm == 0.0) {  // one face, no inside
      mesh.points_mm = {{0, -20, -20}, {0, 20, -20}, {0, 20, 20}, {0, -20, 20}};
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    }
    const SolidPtr wall = solid(mesh);
    for (int i = 0; i < test::effort(30); ++i) {
      std::mt19937_64 random(static_cast<std::uint64_t>(330'000 + i));
      Case c;
      c.a = random_shape(random, i % kShapes);
      c.b = wall;
      c.ask_fcl = thick_mm > 1e-1;
      const double speed = std::pow(10.0, uniform(random, 0.5, 4.0));
      const Vec3 from(-2.5 - uniform(random, 0.0, 1.0), uniform(random, -5, 5),
                      uniform(random, -5, 5));
      const Vec3 to = Vec3(3.0, from.y() * 0.5, from.z() * 0.5) + speed * Vec3::UnitX();
      const Quat q = rotation_exp(random_turn(random, kPi));
      const Vec3 w = i % 2 == 0 ? Vec3(Vec3::Zero()) : random_turn(random, 3.0);
      const Pose X0{q, from}, X1{i % 2 == 0 ? q : (rotation_exp(w) * q).normalized(), to};
      c.motion_a = linear_motion(X0, X1, Vec3::Zero());
      c.motion_b = still_motion({});
      const Pose G{rotation_exp(random_turn(random, kPi)), random_vector(random, 50.0)};
      if (i % 3 == 0) c = moved(c, G);
      const auto state = sweep.ask(c, label("wall", thick_mm, i)).state;
      EXPECT_TRUE(state == ContactState::kContact) << name << " passed in case " << i;
    }
  }
}

// The disease: looking now and then passes the wall, and the judges see it.
TEST(ThinWall, IsPassedByLookingNowAndThen) {
  Case c;
  c.a = solid(box_mesh({1, 1, 1}));
  c.b = solid(box_mesh({1e-6, 20, 20}));
  c.motion_a = slide({-5, 0, 0}, {16, 0, 0});
  c.ask_fcl = false;
  CcdScratch scratch;
  const FirstContact passed = first_contact_by_sampling(query_of(c), 10, scratch);
  ASSERT_EQ(passed.state, ContactState::kFree);
  EXPECT_TRUE(judge(c, passed, 48).missed);
  EXPECT_EQ(first_contact(query_of(c), scratch).state, ContactState::kContact);
}

}  // namespace
}  // namespace mortise::stress
