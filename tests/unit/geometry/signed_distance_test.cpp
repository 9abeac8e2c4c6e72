#include "common/geometry/signed_distance.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/shapes.h"

namespace mortise {
namespace {

using namespace shapes;

std::vector<TriangleMesh> some_meshes() {
  return {box({1, 2, 3}, {.5, 0, 0}, 3), peg({2, -1, 3, 17, 2, .3}),
          ring({2, 0, 3, 12, 2, 0}, 4),  sphere(1.5, {0, 0, 1}, 9),
          u_slot(3, 1, 2, 1, -1, 2),     together(box({1, 1, 1}), box({.5, .5, .5}, {3, 0, 0}))};
}

double sign_by_winding(const TriangleMesh& mesh, const Vec3& x) {
  return winding_number_brute_force(mesh, x) > 0.5 ? 1.0 : -1.0;
}

TEST(SignedDistance, AgreesWithTheSlowTwins) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-5.0, 5.0);
  for (const double offset : {0.0, 1e5})
    for (TriangleMesh mesh : some_meshes()) {
      for (Vec3& x : mesh.points_mm) x.array() += offset;
      const SolidPtr s = solid(mesh);
      ASSERT_TRUE(s->topology().closed());
      for (int i = 0; i < 300; ++i) {
        const Vec3 x = Vec3(unit(random), unit(random), unit(random)).array() + offset;
        const NearestPoint fast = nearest_point(*s, x), slow = nearest_point_brute_force(mesh, x);
        EXPECT_EQ(fast.triangle, slow.triangle);
        EXPECT_DOUBLE_EQ(fast.distance_mm, slow.distance_mm);
        const double sign = sign_by_winding(mesh, x);
        EXPECT_EQ(inside(*s, x), sign > 0.0);
        EXPECT_DOUBLE_EQ(nearest_surface(*s, x).depth_mm, sign * slow.distance_mm);
        EXPECT_DOUBLE_EQ(signed_distance_mm(*s, x), -sign * slow.distance_mm);
      }
    }
}

TEST(SignedDistance, NearEdgesAndCorners) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const TriangleMesh& mesh : some_meshes()) {
    const SolidPtr s = solid(mesh);
    for (std::size_t i = 0; i < mesh.points_mm.size(); ++i)
      for (const double reach : {1e-3, 1e-7}) {
        const Vec3 x = mesh.points_mm[i] + reach * Vec3(unit(random), unit(random), unit(random));
        EXPECT_EQ(nearest_surface(*s, x).depth_mm > 0.0, sign_by_winding(mesh, x) > 0.0);
      }
  }
}

TEST(SignedDistance, LimitAndTies) {
  const SolidPtr s = solid(box({1, 1, 1}));
  EXPECT_EQ(nearest_point(*s, {3, 0, 0}, 1.9).triangle, Topology::kNone);
  EXPECT_DOUBLE_EQ(nearest_point(*s, {3, 0, 0}, 2.1).distance_mm, 2.0);
  // The centre is as near to all six faces: the lowest triangle.
  EXPECT_EQ(nearest_point(*s, Vec3::Zero()).triangle,
            nearest_point_brute_force(s->mesh(), Vec3::Zero()).triangle);
}

/// Also on edges, at corners and where many triangles are equally near.
TEST(SignedDistance, WhereOneBeganToLookChangesNothing) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-4.0, 4.0);
  std::uniform_int_distribution<int> lattice(-16, 16);
  for (const double offset : {0.0, 1e5})
    for (TriangleMesh mesh : some_meshes()) {
      for (Vec3& x : mesh.points_mm) x.array() += offset;
      const SolidPtr s = solid(mesh);
      std::uniform_int_distribution<std::uint32_t> any(
          0, static_cast<std::uint32_t>(mesh.triangles.size() - 1));
      for (int i = 0; i < 900; ++i) {
        Vec3 x(unit(random), unit(random), unit(random));
        if (i % 3 == 0) x = 0.25 * Vec3(lattice(random), lattice(random), lattice(random));
        x.array() += offset;
        const std::uint32_t near = any(random);
        if (i % 3 == 1)
          x = nearest_on_triangle(x, mesh.corner(near, 0), mesh.corner(near, 1),
                                  mesh.corner(near, 2));
        const SurfacePoint from_root = nearest_surface(*s, x);
        for (const std::uint32_t begin : {near, any(random), from_root.triangle}) {
          const SurfacePoint hinted = nearest_surface(*s, x, begin);
          EXPECT_EQ(hinted.triangle, from_root.triangle);
          EXPECT_EQ(hinted.depth_mm, from_root.depth_mm);
          EXPECT_EQ(hinted.point, from_root.point);
          EXPECT_EQ(hinted.outward, from_root.outward);
        }
        EXPECT_EQ(from_root.triangle, nearest_point_brute_force(mesh, x).triangle);
      }
    }
}

TEST(SignedDistance, DirtyMeshesVote) {
  TriangleMesh open = box({1, 1, 1}, Vec3::Zero(), 4);
  open.triangles.pop_back();
  const SolidPtr s = solid(open);
  EXPECT_TRUE(inside(*s, Vec3::Zero()));
  EXPECT_FALSE(inside(*s, {2, 0, 0}));
  // Two overlapping shells in one mesh: their common part is inside.
  const SolidPtr two = solid(together(box({1, 1, 1}), box({1, 1, 1}, {1, 0, 0})));
  EXPECT_TRUE(inside(*two, {0.5, 0, 0}));
  EXPECT_GT(nearest_surface(*two, {0.9, 0, 0}).depth_mm, 0.0);
}

// A planted fault: a sign by the normal of the nearest triangle alone is wrong at sharp edges.
TEST(SignedDistance, TheTestSeesANaiveSign) {
  const TriangleMesh wedge = prism({{0, 0}, {4, -1}, {4, 1}}, {{0, 1, 2}}, 0, 5);
  const SolidPtr s = solid(wedge);
  int wrong = 0;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(-0.5 + 0.4 * unit(random), unit(random), 2.5);
    const SurfacePoint at = nearest_surface(*s, x);
    wrong += at.face_normal.dot(x - at.point) < 0.0;
    EXPECT_LT(at.depth_mm, 0.0);
  }
  EXPECT_GT(wrong, 10);
}

}  // namespace
}  // namespace mortise
