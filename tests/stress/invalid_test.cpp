// Input that no caller may give: a check that names it, or the state that the header documents;
// never anything undefined (the sanitizers look on in the build `dev`).
#include <gtest/gtest.h>

#include <cmath>

#include "common/ccd/start_state.h"
#include "common/geometry/feature.h"
#include "common/geometry/signed_distance.h"
#include "common/geometry/triangle_distance.h"
#include "tests/stress/meshes.h"
#include "tests/stress/record.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

std::vector<Pose> bad_poses() {
  std::vector<Pose> bad;
  for (const double x : {kNan, kInf, -kInf, 1e13, 1e300}) {
    bad.push_back(shift(0, x, 0));
    Pose X;
    X.q.y() = x;
    bad.push_back(X);
  }
  Pose long_q, zero_q;
  long_q.q.coeffs() *= 1.1;
  zero_q.q.coeffs().setZero();
  bad.push_back(long_q);
  bad.push_back(zero_q);
  return bad;
}

TriangleMesh bad_mesh(double x) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.points_mm[3].z() = x;
  return mesh;
}

TriangleMesh bad_index() {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles[5][1] = 8;
  return mesh;
}

TEST(InvalidDeathTest, Motions) {
  for (const Pose& X : bad_poses()) {
    EXPECT_FALSE(valid(X));
    EXPECT_DEATH(still_motion(X), "check failed.*finite");
    EXPECT_DEATH(linear_motion(X, Pose(), Vec3::Zero()), "check failed.*finite");
    EXPECT_DEATH(linear_motion({}, X, Vec3::Zero()), "check failed.*finite");
    EXPECT_DEATH(screw_motion({}, X, Vec3::Zero()), "check failed.*finite");
    EXPECT_DEATH(seen_from(Motion{}, X), "check failed.*finite");
  }
  EXPECT_DEATH(linear_motion({}, {}, {0, kNan, 0}), "reference point");
  EXPECT_DEATH(screw_motion({}, {}, {kInf, 0, 0}), "reference point");
  const Motion good = linear_motion({}, turn({0, 0, 1}, {1, 2, 3}), Vec3::Zero());
  EXPECT_TRUE(valid(good));
  EXPECT_DEATH(good.pose_at(kNan), "a time");
  EXPECT_DEATH(until(good, kNan), "a time");
  EXPECT_DEATH(good.travel_upper_bound_mm(-1.0, 0.0, 1.0), "a radius");
  EXPECT_DEATH(good.travel_upper_bound_mm(kNan, 0.0, 1.0), "a radius");
  EXPECT_DEATH(good.travel_upper_bound_mm(1.0, kNan, 1.0), "times");
  // Documented: beyond the ends nothing moves.
  EXPECT_TRUE(identical(good.pose_at(-kInf), good.X_W0));
  EXPECT_TRUE(identical(good.pose_at(kInf), good.X_W1));
  EXPECT_TRUE(identical(until(good, 7.0).X_W1, good.X_W1));
  EXPECT_FALSE(until(good, -kInf).moves());
  EXPECT_EQ(good.travel_upper_bound_mm(1.0, 1.0, 0.0), 0.0);
}

TEST(Invalid, MotionsMadeByHand) {
  const Motion good = linear_motion({}, turn({0, 0, 1}, {1, 2, 3}), Vec3::Zero());
  const auto spoiled = [&](auto change) {
    Motion m = good;
    change(m);
    return valid(m);
  };
  EXPECT_FALSE(spoiled([](Motion& m) { m.kind = static_cast<PathKind>(77); }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.v_W.x() = kNan; }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.w_W.x() = kNan; }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.w_W = Vec3(0, 0, 3.2); }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.axis_W.y() = kInf; }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.reference_P.y() = kInf; }));
  EXPECT_FALSE(spoiled([](Motion& m) { m.X_W1.p.y() = kInf; }));
  EXPECT_TRUE(spoiled([](Motion& m) { m.w_W = Vec3(0, 0, kPi); }));
  EXPECT_TRUE(valid(Motion{}));
}

TEST(InvalidDeathTest, Meshes) {
  for (const double x : {kNan, kInf, -kInf, 1e13}) {
    const TriangleMesh mesh = bad_mesh(x);
    EXPECT_FALSE(valid(mesh));
    EXPECT_DEATH(Solid{mesh}, "coordinates must be finite");
    EXPECT_DEATH(build_topology(mesh), "coordinates must be finite");
    EXPECT_DEATH(first_triangle_of_each_shell(mesh), "coordinates must be finite");
    EXPECT_DEATH(signed_volume_mm3(mesh), "coordinates must be finite");
  }
  EXPECT_FALSE(valid(bad_index()));
  EXPECT_DEATH(Solid{bad_index()}, "indices must name points");
  EXPECT_DEATH(build_topology(bad_index()), "indices must name points");
  EXPECT_DEATH(build_topology_brute_force(bad_index()), "indices must name points");
  EXPECT_DEATH(first_triangle_of_each_shell(bad_index()), "indices must name points");
  EXPECT_DEATH(signed_volume_mm3(bad_index()), "indices must name points");
  // Nothing at all is a mesh, but has no tree.
  const Solid empty{TriangleMesh{}};
  EXPECT_EQ(empty.topology().components, 0U);
  EXPECT_TRUE(empty.shells().empty());
  EXPECT_TRUE(empty.bounds().empty());
  EXPECT_DEATH(empty.bvh(), "at least one triangle");
  EXPECT_DEATH(nearest_point(empty, {0, 0, 0}), "at least one triangle");
}

TEST(InvalidDeathTest, PointsAndSurfaces) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  for (const double x : {kNan, kInf, -kInf}) {
    EXPECT_DEATH(nearest_point(*cube, {x, 0, 0}), "must be numbers");
    EXPECT_DEATH(nearest_surface(*cube, {x, 0, 0}), "must be finite");
    EXPECT_DEATH(inside(*cube, {0, x, 0}), "must be finite");
    EXPECT_DEATH(signed_distance_mm(*cube, {0, 0, x}), "must be finite");
  }
  EXPECT_DEATH(nearest_point(*cube, {0, 0, 0}, kNan), "must be numbers");
  // Documented: beyond the limit nothing is found, below zero nothing ever.
  EXPECT_EQ(nearest_point(*cube, {3, 0, 0}, -1.0).triangle, Topology::kNone);
  EXPECT_EQ(nearest_point(*cube, {3, 0, 0}, 1.0).triangle, Topology::kNone);
  Surface cone;
  cone.kind = SurfaceKind::kCone;
  cone.half_angle_rad = 0.5;
  EXPECT_DEATH(cone.signed_distance_range_mm({kNan, 0, 0}, {1, 0, 1}, {0, 1, 1}), "finite");
  EXPECT_DEATH(cone.signed_distance_range_mm({1, 1, 1}, {1, 0, 1}, {0, 1, 1}, 0.0), "positive");
  EXPECT_DEATH(cone.signed_distance_range_mm({1, 1, 1}, {1, 0, 1}, {0, 1, 1}, kNan), "positive");
}

// No check, by contract: no number comes out, and nothing else happens.
TEST(Invalid, TrianglesThatAreNoNumbers) {
  const Triangle good = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double x : {kNan, kInf, 1e300})
    for (int k = 0; k < 3; ++k) {
      Triangle bad = good;
      bad[k].y() = x;
      triangle_distance(bad, good);
      triangle_distance(good, bad);
      triangle_distance_apart(bad, good);
      triangle_separation(bad, good);
      triangle_separation_outside(good, bad);
      triangles_cross(bad, good);
    }
}

TEST(InvalidDeathTest, Contained) {
  const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  for (const Pose& X : bad_poses()) {
    EXPECT_DEATH(contained(*cube, X, *cube, {}, 1e-6), "check failed.*finite");
    EXPECT_DEATH(contained(*cube, {}, *cube, X, 1e-6), "check failed.*finite");
  }
  for (const double margin : {-1e-9, kNan, kInf})
    EXPECT_DEATH(contained(*cube, {}, *cube, {}, margin), "a margin");
}

}  // namespace
}  // namespace mortise::stress
