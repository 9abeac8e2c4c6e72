// Contact times that are known in closed form (ccd/README.md, section 7).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

// Never late, and early by no more than the accuracy along the way.
void expect_contact(const FirstContact& c, double t, double closing_speed_mm,
                    double accuracy_mm = kAccuracyDefault_mm) {
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_LE(c.t_contact, t + 1e-14 + 1e-11 / closing_speed_mm);
  EXPECT_GE(c.t_contact, t - accuracy_mm / closing_speed_mm - 1e-14);
  EXPECT_EQ(c.t_clear, c.t_contact);
  EXPECT_GT(c.distance_mm, 0.0) << "already overlapping";
  EXPECT_LE(c.distance_mm, accuracy_mm);
  EXPECT_NEAR((c.point_a_W - c.point_b_W).norm(), c.distance_mm, 1e-12);
}

// The mesh of a sphere contains the ball of this part of its radius.
double inner_ratio(const TriangleMesh& sphere) {
  double least = 1.0;
  for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) {
    const Vec3 n = (sphere.corner(t, 1) - sphere.corner(t, 0))
                       .cross(sphere.corner(t, 2) - sphere.corner(t, 0))
                       .normalized();
    least = std::min(least, n.dot(sphere.corner(t, 0)) / sphere.corner(t, 0).norm());
  }
  return least;
}

double spheres_meet(double sum_of_radii, double y) {
  return (8.0 - std::sqrt(sum_of_radii * sum_of_radii - y * y)) / 10.0;
}

TEST(Analytic, SpheresWithinTheBracketOfTheirMeshes) {
  const TriangleMesh small = sphere_mesh(1.0, 96, 48), large = sphere_mesh(2.0, 96, 48);
  const double least_sum = 1.0 * inner_ratio(small) + 2.0 * inner_ratio(large);
  const SolidPtr a = solid(small), b = solid(large);
  EXPECT_NEAR(spheres_meet(3.0, 1.0), 0.517157287525, 1e-12);
  for (double y : {0.0, 1.0, 2.0}) {
    const FirstContact c = solve(a, slide({0, 0, 0}, {10, 0, 0}), b, still_motion(shift(8, y, 0)));
    ASSERT_EQ(c.state, ContactState::kContact) << y;
    EXPECT_GE(c.t_contact, spheres_meet(3.0, y) - 1e-6) << y;
    EXPECT_LE(c.t_contact, spheres_meet(least_sum, y) + 1e-9) << y;
  }
  // Past each other: the true spheres touch at t = 0.8 only, their meshes at most there.
  const FirstContact grazing =
      solve(a, slide({0, 0, 0}, {10, 0, 0}), b, still_motion(shift(8, 3, 0)));
  if (grazing.state == ContactState::kContact) {
    EXPECT_NEAR(grazing.t_contact, 0.8, 1e-3);
  } else {
    EXPECT_EQ(grazing.state, ContactState::kFree);
  }
  EXPECT_EQ(solve(a, slide({0, 0, 0}, {10, 0, 0}), b, still_motion(shift(8, 3 + 1e-6, 0))).state,
            ContactState::kFree);
}

TEST(Analytic, CubesAndThinWalls) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  expect_contact(solve(cube, slide({0, 0, 0}, {10, 0, 0}), cube, still_motion(shift(5, 0, 0))), 0.4,
                 10);
  const SolidPtr foil = solid(box_mesh({0.001, 20, 20}));
  expect_contact(solve(cube, slide({0, 0, 0}, {20, 0, 0}), foil, still_motion(shift(5.3, 0, 0))),
                 (5.3 - 0.0005 - 0.5) / 20, 20);
  EXPECT_NEAR((5.3 - 0.0005 - 0.5) / 20, 0.239975, 1e-15);
  const SolidPtr wall = solid(box_mesh({0.1, 20, 20}));
  expect_contact(solve(cube, slide({0, 0, 0}, {20, 0, 0}), wall, still_motion(shift(5.3, 0, 0))),
                 0.2375, 20);
}

TEST(Analytic, LookingNowAndThenMissesTheWallThatWeFind) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1})), foil = solid(box_mesh({0.001, 20, 20}));
  const ContactQuery q =
      query(cube, slide({0, 0, 0}, {20, 0, 0}), foil, still_motion(shift(5.3, 0, 0)));
  CcdScratch scratch;
  // Ten looks on the way: the cube is before the foil, then behind it.
  EXPECT_EQ(first_contact_by_sampling(q, 10, scratch).state, ContactState::kFree);
  expect_contact(first_contact(q, scratch), 0.239975, 20);
}

TEST(Analytic, TurningBar) {
  const SolidPtr bar = solid(box_mesh({4, 0.2, 0.2})), cube = solid(box_mesh({0.2, 0.2, 0.2}));
  const Motion still = still_motion(shift(0, 1.5, 0));
  // 1.4 cos a - 0.1 sin a = 0.1. The fastest point goes 2 * pi / 2 mm a tick.
  expect_contact(solve(bar, move({}, turn({0, 0, kPi / 2})), cube, still), 0.90920851603, 1.4);
  expect_contact(solve(bar, move({}, turn({0, 0, kPi})), cube, still), 0.454604258015, 2.8);
  expect_contact(solve(bar, move({}, turn({0, 0, kPi - 1e-12})), cube, still), 0.454604258015, 2.8);
  // Half a turn by way of the other side ends in the same pose; here the cube stands on that side.
  expect_contact(
      solve(bar, move({}, turn({0, 0, -(kPi - 1e-12)})), cube, still_motion(shift(0, -1.5, 0))),
      0.454604258015, 2.8);
  // The bar still, the cube going round.
  const Motion round =
      linear_motion(shift(0, 1.5, 0), turn({0, 0, -kPi / 2}, {1.5, 0, 0}), Vec3(0, -1.5, 0));
  expect_contact(solve(cube, round, bar), 0.90920851603, 1.4);
  expect_contact(solve(bar, Motion{}, cube, round), 0.90920851603, 1.4);
}

TEST(Analytic, TurningBarMeetsASphere) {
  const TriangleMesh mesh = sphere_mesh(0.2, 64, 32);
  const double r = 0.2 * inner_ratio(mesh);
  const FirstContact c = solve(solid(box_mesh({4, 0.2, 0.2})), move({}, turn({0, 0, kPi})),
                               solid(mesh), still_motion(shift(0, 1.5, 0)));
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(std::acos(0.2) / kPi, 0.435905783, 1e-9);
  EXPECT_GE(c.t_contact, std::acos(0.2) / kPi - 1e-6);
  EXPECT_LE(c.t_contact, std::acos((0.1 + r) / 1.5) / kPi + 1e-9);
}

TEST(Analytic, PointOnAScrew) {
  const SolidPtr dart = solid(
      tetrahedron_mesh({1, 0, 0}, {0.9, 0.005, 0}, {0.9, -0.005, 0.005}, {0.9, -0.005, -0.005}));
  const SolidPtr wall = solid(box_mesh({10, 1, 10}, {0, 1, 0}));
  const FirstContact c =
      solve(dart, screw_motion({}, turn({0, 0, kPi}, {0, 0, 2}), Vec3::Zero()), wall);
  expect_contact(c, 1.0 / 6.0, 2.7);
  EXPECT_NEAR(c.point_a_W.z(), 1.0 / 3.0, 1e-5);
}

TEST(Analytic, PathMatters) {
  // A small cube stands where only the screw path passes (1, 1 - sqrt 2), and where only the linear
  // one does (1, 0).
  const SolidPtr pin = solid(box_mesh({0.01, 0.01, 0.01})), cube = solid(box_mesh({0.1, 0.1, 0.1}));
  const Pose end = turn({0, 0, kPi / 2}, {2, 0, 0});
  const Motion linear = linear_motion({}, end, Vec3::Zero()),
               screw = screw_motion({}, end, Vec3::Zero());
  const Motion below = still_motion(shift(1, 1 - std::numbers::sqrt2, 0));
  const Motion between = still_motion(shift(1, 0, 0));
  EXPECT_EQ(solve(pin, screw, cube, below).state, ContactState::kContact);
  EXPECT_EQ(solve(pin, linear, cube, below).state, ContactState::kFree);
  EXPECT_EQ(solve(pin, screw, cube, between).state, ContactState::kFree);
  EXPECT_EQ(solve(pin, linear, cube, between).state, ContactState::kContact);
}

double tilt(double r, double bore, double length) {
  return std::asin(bore / std::hypot(r, length / 2)) - std::atan2(r, length / 2);
}

TEST(Analytic, TiltInABore) {
  EXPECT_NEAR(tilt(9.95, 10, 25), 0.004006399101, 1e-12);
  const int n = 64;
  const double flat = std::cos(kPi / n);
  const SolidPtr peg = solid(prism_mesh(9.95, n, -12.5, 12.5));
  const SolidPtr bore = solid(tube_mesh(10, 20, n, -40, 40));
  const FirstContact c = solve(peg, move({}, turn({0.02, 0, 0})), bore);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_GE(0.02 * c.t_contact, tilt(9.95, 10 * flat, 25) - 1e-6);
  EXPECT_LE(0.02 * c.t_contact, tilt(9.95 * flat, 10, 25) + 1e-9);
}

TEST(Analytic, RadialPushInABore) {
  const int n = 32;
  const SolidPtr peg = solid(prism_mesh(9.95, n, -12.5, 12.5));
  const SolidPtr bore = solid(tube_mesh(10, 20, n, -40, 40));
  // Towards a corner: corner gap 0.05. The flats beside it close first: 0.05 cos(pi/n) along their
  // normals, which stand at pi/n to the push: 0.05 again. Towards a flat: 0.05 cos(pi/n).
  expect_contact(solve(peg, slide({0, 0, 0}, {1, 0, 0}), bore), 0.05, 0.9);
  const Vec3 to_flat(std::cos(kPi / n), std::sin(kPi / n), 0);
  expect_contact(solve(peg, slide({0, 0, 0}, to_flat), bore), 0.05 * std::cos(kPi / n), 1.0);
  EXPECT_NEAR(0.05 * std::cos(kPi / n), 0.049759, 1e-6);
  // Along the bore and turning with its facets in line it never touches.
  EXPECT_EQ(solve(peg, slide({0, 0, -5}, {0, 0, 5}), bore).state, ContactState::kFree);
}

TEST(Analytic, MinimumSeparation) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  ContactQuery q = query(cube, slide({0, 0, 0}, {10, 0, 0}), cube, still_motion(shift(5, 0, 0)));
  q.separation_mm = 0.5;
  const FirstContact c = solve(q);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_LE(c.t_contact, 0.35);
  EXPECT_GE(c.t_contact, 0.35 - 1e-7);
  EXPECT_NEAR(c.distance_mm, 0.5, 1e-6);
  EXPECT_GT(c.distance_mm, 0.5);
  q.separation_mm = 4.5;  // already so near
  EXPECT_EQ(solve(q).state, ContactState::kTouchingAtStart);
  EXPECT_NEAR(solve(q).distance_mm, 4.0, 1e-12);
}

TEST(Analytic, GrazingIsTouchingOrNot) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  const auto pass = [&](double height) {
    return solve(cube, slide({-5, 0, height}, {5, 0, height}), cube).state;
  };
  EXPECT_EQ(pass(1.0 + 2e-6), ContactState::kFree);
  EXPECT_EQ(pass(1.0 + 1e-12), ContactState::kContact);
  EXPECT_EQ(pass(1.0), ContactState::kContact);
  EXPECT_EQ(pass(1.0 - 1e-12), ContactState::kContact);
  expect_contact(solve(cube, slide({-5, 0, 1.0 - 1e-9}, {5, 0, 1.0 - 1e-9}), cube), 0.4, 10);
}

TEST(Analytic, TwoMovers) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  // Swapping places in one tick: their ends are free, their ways are not.
  expect_contact(solve(cube, slide({0, 0, 0}, {10, 0, 0}), cube, slide({10, 0, 0}, {0, 0, 0})),
                 0.45, 20);
  // The same velocity: never, at any gap.
  for (double gap : {1.0, 1e-3, 1e-5}) {
    const FirstContact c =
        solve(cube, slide({0, 0, 0}, {10, 3, 1}), cube, slide({1 + gap, 0, 0}, {11 + gap, 3, 1}));
    EXPECT_EQ(c.state, ContactState::kFree);
    EXPECT_LT(c.work.advances, 200U);
  }
  // One rigid group on one screw, 0.01 mm apart.
  const Pose a0 = shift(3, 0, 0), b0 = shift(4.01, 0, 0), G = turn({0, 0, 1.5}, {0, 0, 7});
  const FirstContact group = solve(cube, screw_motion(a0, G * a0, Vec3::Zero()), cube,
                                   screw_motion(b0, G * b0, Vec3::Zero()));
  EXPECT_EQ(group.state, ContactState::kFree);
  // Two bars that turn towards each other meet half way: each as far as one alone at twice the
  // speed would by symmetry.
  const SolidPtr bar = solid(box_mesh({2, 0.2, 0.2}, {1, 0, 0}));
  const Motion up = move({}, turn({0, 0, 1.0})), down = move(turn({0, 0, 1.2}), turn({0, 0, 0.2}));
  const FirstContact both = solve(bar, up, bar, down);
  EXPECT_EQ(both.state, ContactState::kOverlappingAtStart) << "they share the hinge";
  const SolidPtr outer = solid(box_mesh({1, 0.2, 0.2}, {2, 0, 0}));
  const FirstContact one =
      solve(outer, move({}, turn({0, 0, 2.0})), outer, still_motion(turn({0, 0, 1.2})));
  const FirstContact two = solve(outer, up, outer, down);
  ASSERT_EQ(one.state, ContactState::kContact);
  ASSERT_EQ(two.state, ContactState::kContact);
  EXPECT_NEAR(one.t_contact, two.t_contact, 1e-6);
}

}  // namespace
}  // namespace mortise::testing
