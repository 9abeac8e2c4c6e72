#include "common/geometry/bvh/bvh.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/support/float_traps.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

// What is wrong with a tree, as counts.
struct Faults {
  int missing = 0;      ///< triangles that are not in exactly one leaf
  int outside = 0;      ///< corners outside of a box above them
  int outside_own = 0;  ///< the same of the boxes in axes of their own
  int own = 0;          ///< nodes that have such
  int corners = 0;      ///< corners that are not those of the mesh
  int depth = 0;        ///< of the deepest leaf
  int sum() const { return missing + outside + outside_own + corners; }
};

Faults faults_of(const TriangleMesh& mesh, const Bvh& bvh) {
  Faults faults;
  std::vector<int> seen(mesh.triangles.size(), 0);
  std::vector<Box> above{bvh.bounds};
  std::vector<std::pair<const Bvh::Oriented*, int>> above_own;
  const auto outside_own = [&](const Bvh::Oriented& boxes, int child, const Vec3& x) {
    const Vec3 own = boxes.axes * (x - bvh.origin - boxes.from_origin);
    bool outside = own.norm() > boxes.radius_mm;
    for (int c = 0; c < 3; ++c)
      outside = outside || std::fabs(own[c] - static_cast<double>(boxes.center[c][child])) >
                               static_cast<double>(boxes.half[c][child]);
    return outside;
  };
  const auto visit = [&](auto&& self, std::int32_t child) -> void {
    faults.depth = std::max(faults.depth, static_cast<int>(above.size()) - 1);
    if (child >= 0) {
      const Bvh::Node& node = bvh.nodes[child];
      EXPECT_GE(node.count, 2);
      for (int k = node.count; k < Bvh::kWidth; ++k) EXPECT_EQ(node.child[k], node.child[0]);
      const bool own = node.oriented >= 0;
      faults.own += own;
      for (int k = 0; k < node.count; ++k) {
        above.push_back(bvh.child_box(node, k));
        if (own) above_own.emplace_back(&bvh.oriented[node.oriented], k);
        self(self, node.child[k]);
        above.pop_back();
        if (own) above_own.pop_back();
      }
      return;
    }
    const Bvh::Leaf& leaf = bvh.leaves[~child];
    EXPECT_GE(leaf.count, 1U);
    EXPECT_LE(leaf.count, static_cast<unsigned>(Bvh::kLeafSize));
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      ++seen[bvh.triangle_order[i]];
      for (int k = 0; k < 3; ++k) {
        const Vec3& x = mesh.corner(bvh.triangle_order[i], k);
        for (const Box& box : above)
          faults.outside +=
              (x.array() < box.lo.array()).any() || (x.array() > box.hi.array()).any();
        for (const auto& [boxes, slot] : above_own)
          faults.outside_own += outside_own(*boxes, slot, x);
        const double* held = bvh.corners[i].data() + 3 * k;
        faults.corners += x != Vec3(held[0], held[1], held[2]);
      }
    }
  };
  visit(visit, bvh.root);
  for (const int times : seen) faults.missing += times != 1;
  return faults;
}

bool same(const Bvh& a, const Bvh& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  bool own = a.oriented.size() == b.oriented.size();
  for (std::size_t i = 0; own && i < a.oriented.size(); ++i) {
    const Bvh::Oriented &x = a.oriented[i], &y = b.oriented[i];
    own = std::memcmp(x.center, y.center, sizeof x.center) == 0 &&
          std::memcmp(x.half, y.half, sizeof x.half) == 0 && x.axes == y.axes &&
          x.from_origin == y.from_origin && x.radius_mm == y.radius_mm;
  }
  return own && a.root == b.root && equal(a.nodes, b.nodes) && equal(a.leaves, b.leaves) &&
         equal(a.triangle_order, b.triangle_order) && equal(a.corners, b.corners) &&
         a.radius_mm == b.radius_mm && a.extent_mm == b.extent_mm && a.origin == b.origin;
}

TriangleMesh soup(std::mt19937_64& random, int triangles, double size_mm) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  TriangleMesh mesh;
  for (int t = 0; t < triangles; ++t) {
    const Vec3 at = 100.0 * Vec3(unit(random), unit(random), unit(random));
    const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
    for (int k = 0; k < 3; ++k)
      mesh.points_mm.push_back(at + size_mm * Vec3(unit(random), unit(random), unit(random)));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TriangleMesh one_triangle() {
  TriangleMesh mesh;
  mesh.points_mm = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

// Each a little smaller than the one before, towards the middle, where single precision is finest:
// by area alone few at a time would be split off.
TriangleMesh shrinking(int triangles) {
  TriangleMesh mesh;
  double size = 1e6;
  for (int t = 0; t < triangles; ++t, size *= 0.97) {
    const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
    for (const Vec3& x : one_triangle().points_mm)
      mesh.points_mm.push_back((t % 2 == 0 ? size : -size) * (x + Vec3(1, 1, 1)));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<std::pair<const char*, TriangleMesh>> meshes() {
  std::mt19937_64 random(51);
  std::vector<std::pair<const char*, TriangleMesh>> all;
  all.emplace_back("sphere", shapes::sphere(10.0, {1, 2, 3}, 40));
  all.emplace_back("flat boxes", shapes::box({1, 2, 3}, Vec3::Zero(), 20));
  all.emplace_back("soup", soup(random, 3000, 10.0));
  all.emplace_back("one triangle", one_triangle());
  TriangleMesh copies = one_triangle();
  copies.triangles.resize(1000, copies.triangles[0]);
  all.emplace_back("all in one place", copies);
  TriangleMesh point = copies;
  point.points_mm = {Vec3(3, 4, 5), Vec3(3, 4, 5), Vec3(3, 4, 5)};
  all.emplace_back("all one point", point);
  all.emplace_back("far off", shapes::sphere(10.0, {1e7, -1e7, 1e7}, 40));
  all.emplace_back("tiny", shapes::scaled(shapes::sphere(10.0, {1, 2, 3}, 30), 1e-6));
  all.emplace_back("huge", shapes::scaled(shapes::sphere(10.0, {1, 2, 3}, 30), 1e6));
  all.emplace_back("shrinking", shrinking(4000));
  return all;
}

TEST(Bvh, HoldsEveryTriangleOnceInEveryBoxAbove) {
  const test::FloatTraps traps;
  for (const auto& [name, mesh] : meshes()) {
    const Bvh bvh = build_bvh(mesh);
    const Faults faults = faults_of(mesh, bvh);
    EXPECT_EQ(faults.missing, 0) << name;
    EXPECT_EQ(faults.outside, 0) << name;
    EXPECT_EQ(faults.outside_own, 0) << name;
    EXPECT_EQ(faults.corners, 0) << name;
    // Those who walk the tree hold stacks of 7 x 45 + 8.
    EXPECT_LE(faults.depth, 45) << name;
  }
}

TEST(Bvh, TheCheckSeesPlantedFaults) {
  const test::FloatTraps traps;
  const TriangleMesh mesh = shapes::sphere(10.0, {1, 2, 3}, 20);
  const Bvh good = build_bvh(mesh);
  ASSERT_EQ(faults_of(mesh, good).sum(), 0);
  Bvh bad = good;
  bad.nodes[0].half[1][0] *= 0.999F;
  EXPECT_GT(faults_of(mesh, bad).outside, 0);
  bad = good;
  ASSERT_GT(faults_of(mesh, good).own, 0) << "a sphere is made of patches";
  bad.oriented[0].half[2][0] *= 0.9F;
  EXPECT_GT(faults_of(mesh, bad).outside_own, 0);
  EXPECT_FALSE(same(good, bad));
  bad = good;
  bad.triangle_order[3] = bad.triangle_order[4];
  EXPECT_GT(faults_of(mesh, bad).missing, 0);
  bad = good;
  bad.corners[7][2] = std::nextafter(bad.corners[7][2], 100.0);
  EXPECT_EQ(faults_of(mesh, bad).corners, 1);
  EXPECT_FALSE(same(good, bad));
}

TEST(Bvh, IsTheSameAtAnyNumberOfThreads) {
  const test::FloatTraps traps;
  std::mt19937_64 random(52);
  std::vector<TriangleMesh> large;
  large.push_back(shapes::sphere(10.0, {1, 2, 3}, 120));
  large.push_back(soup(random, 60'000, 1.0));
  TriangleMesh copies = one_triangle();
  copies.triangles.resize(20'000, copies.triangles[0]);
  large.push_back(copies);
  for (const TriangleMesh& mesh : large) {
    const Bvh one = build_bvh(mesh, 1);
    EXPECT_EQ(faults_of(mesh, one).sum(), 0);
    for (const int threads : {0, 2, 4, 7})
      EXPECT_TRUE(same(build_bvh(mesh, threads), one)) << threads << " threads";
  }
  EXPECT_FALSE(same(build_bvh(large[0]), build_bvh(large[1])));
}

TEST(Bvh, BytesStayWithinTheirLimit) {
  const test::FloatTraps traps;
  const TriangleMesh mesh = shapes::sphere(50.0, Vec3::Zero(), 360);
  ASSERT_GT(mesh.triangles.size(), 250'000U);
  const Bvh bvh = build_bvh(mesh);
  const double bytes =
      static_cast<double>(bvh.bytes()) / static_cast<double>(mesh.triangles.size());
  std::printf("%.1f bytes a triangle\n", bytes);
  EXPECT_LE(bytes, 125.0) << "with the topology's 25: 150";
  EXPECT_GE(bytes, 76.0) << "the corners and their ids alone";
}

TEST(Bvh, RefusesWhatIsNoNumber) {
  const test::FloatTraps traps;
  EXPECT_DEATH(build_bvh(TriangleMesh{}), "at least one triangle");
  for (const double x :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e13}) {
    TriangleMesh mesh = shapes::box({1, 1, 1});
    mesh.points_mm[3].y() = x;
    EXPECT_DEATH(build_bvh(mesh), "finite coordinates");
  }
}

}  // namespace
}  // namespace mortise
