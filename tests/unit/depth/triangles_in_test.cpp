// The triangles in a box and a slab, by the tree, beside a look at every triangle.
#include "common/depth/triangles_in.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "tests/support/effort.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

class TrianglesIn : public testing::Test {
 protected:
  double uniform(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  Vec3 any_point(double half_mm) {
    return {uniform(-half_mm, half_mm), uniform(-half_mm, half_mm), uniform(-half_mm, half_mm)};
  }
  Box any_box(const Box& of_part) {
    const Vec3 x = of_part.center() + any_point(0.6 * of_part.half().norm());
    Box box;
    box.add(x);
    box.add(x + any_point(of_part.half().norm()));
    return box;
  }

  std::mt19937_64 random_{7};
};

std::set<std::uint32_t> by_each(const TriangleMesh& mesh, const Box& box, const Slab& slab) {
  std::set<std::uint32_t> found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Box own;
    Interval along{kInfinity, -kInfinity};
    for (int k = 0; k < 3; ++k) {
      own.add(mesh.corner(t, k));
      const double at = slab.normal.dot(mesh.corner(t, k));
      along = hull(along, {at, at});
    }
    const bool apart = (own.lo.array() > box.hi.array()).any() ||
                       (own.hi.array() < box.lo.array()).any() || along.lo > slab.between_mm.hi ||
                       along.hi < slab.between_mm.lo;
    if (!apart) found.insert(t);
  }
  return found;
}

std::set<std::uint32_t> by_tree(const Bvh& bvh, const Box& box, const Slab& slab) {
  std::set<std::uint32_t> found;
  for_each_triangle_in(bvh, box, slab, [&](std::uint32_t t, const auto&) { found.insert(t); });
  return found;
}

TEST_F(TrianglesIn, AreThoseThatALookAtEachFinds) {
  const Vec3 far(3e5, -2e5, 1e5);
  std::vector<TriangleMesh> meshes = {shapes::sphere(20.0, Vec3::Zero(), 24),
                                      shapes::box({20, 15, 10}, Vec3::Zero(), 7),
                                      shapes::ring({12, -10, 10, 96, 5, 0}, 25)};
  meshes.push_back(shapes::sphere(20.0, far, 24));  // where a coordinate has fewer digits left
  std::size_t some = 0;
  for (const TriangleMesh& mesh : meshes) {
    const Solid solid(mesh);
    for (int i = 0; i < test::effort(300); ++i) {
      const Box box = any_box(solid.bounds());
      Slab slab;
      if (i % 4 != 0) {
        slab.normal = any_point(1.0).normalized();
        const double at = slab.normal.dot(box.center());
        slab.between_mm = {at - uniform(0.0, 3.0), at + uniform(0.0, 3.0)};
      }
      const auto all = by_each(mesh, box, slab);
      some += !all.empty();
      EXPECT_EQ(by_tree(solid.bvh(), box, slab), all) << i;
    }
  }
  EXPECT_GT(some, 300U);
}

// A slab may just touch triangles, as that of a patch on their own plane does.
TEST_F(TrianglesIn, ThatASlabJustTouchesAreFound) {
  const TriangleMesh mesh = shapes::sphere(20.0, Vec3::Zero(), 24);
  const Solid solid(mesh);
  Box all;
  for (const Vec3& x : mesh.points_mm) all.add(x);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Slab slab;
    slab.normal = solid.topology().normal[t];
    const double at = slab.normal.dot(mesh.corner(t, 0));
    slab.between_mm = {at, at + 1.0};
    EXPECT_TRUE(by_tree(solid.bvh(), all, slab).contains(t));
  }
}

TEST_F(TrianglesIn, EndWithTheVisitThatTellsFalse) {
  const Solid solid(shapes::sphere(20.0, Vec3::Zero(), 24));
  int visited = 0;
  for_each_triangle_in(solid.bvh(), solid.bounds(),
                       [&](std::uint32_t, const auto&) { return ++visited < 5; });
  EXPECT_EQ(visited, 5);
}

}  // namespace
}  // namespace mortise
