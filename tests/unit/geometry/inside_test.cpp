// What has an inside, and where it is known (geometry/README.md, section 4).
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/geometry/border.h"
#include "common/geometry/cracks.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

using shapes::box;
using shapes::together;

/// The same triangles over points of which none stands at the place of another.
TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::map<std::array<double, 3>, std::uint32_t> number;
  for (auto triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      const Vec3& x = mesh.points_mm[corner];
      const auto [at, fresh] =
          number.try_emplace({x.x(), x.y(), x.z()}, static_cast<std::uint32_t>(number.size()));
      if (fresh) out.points_mm.push_back(x);
      corner = at->second;
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

/// Every random point has the side and the distance that all solid angles and triangles say.
void expect_true_signs(const TriangleMesh& mesh, std::uint64_t seed) {
  const Solid solid(mesh);
  ASSERT_TRUE(solid.has_inside());
  std::mt19937_64 random(seed);
  const Vec3 center = solid.bounds().center(), reach = 1.2 * solid.bounds().half();
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    // On planes and lines through the middle, too: there the nearest point is an edge or a corner.
    Vec3 x(unit(random), unit(random), unit(random));
    if (i % 3 == 0) x[1] = x[0];
    if (i % 5 == 0) x[2] = x[1] = -x[0];
    x = center + x.cwiseProduct(reach);
    const double distance = nearest_point_brute_force(mesh, x).distance_mm;
    if (distance < 1e-9) continue;
    const bool in = winding_number_brute_force(mesh, x) > 0.5;
    EXPECT_NEAR(nearest_surface(solid, x).depth_mm, in ? distance : -distance, 1e-9)
        << x.transpose();
  }
}

TEST(Inside, CubesThatShareAnEdgeAFaceOrACorner) {
  for (const Vec3& shift : {Vec3(2, 2, 0), Vec3(2, 0, 0), Vec3(2, 2, 2)}) {
    const TriangleMesh mesh = welded(together(box({1, 1, 1}), box({1, 1, 1}, shift)));
    const Topology topology = build_topology(mesh);
    EXPECT_TRUE(topology.closed());
    EXPECT_FALSE(topology.manifold());
    EXPECT_NEAR(topology.volume_mm3, 16.0, 1e-12);
    expect_true_signs(mesh, 51);
  }
}

TEST(Inside, ACubeOfWhichEveryTriangleOccursTwice) {
  TriangleMesh mesh = box({1, 1, 1});
  const auto once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
  EXPECT_TRUE(build_topology(mesh).closed());
  EXPECT_EQ(winding_number(Solid(mesh), {0.1, 0.2, 0.3}), 2);
  expect_true_signs(mesh, 52);
}

TEST(Inside, ShellsThatOverlapAndTouch) {
  expect_true_signs(together(box({2, 2, 2}), box({1, 1, 3}, {0, 0, 3})), 53);
  expect_true_signs(welded(together(box({2, 2, 2}), box({1, 1, 1}, {0, 0, 3}))), 54);
}

TEST(Inside, EdgesThatDoNotBalanceAreABorder) {
  TriangleMesh mesh = box({1, 1, 1});
  EXPECT_TRUE(border_of(mesh.triangles).empty());
  const auto gone = mesh.triangles.back();
  mesh.triangles.pop_back();
  const std::vector<BorderEdge> border = border_of(mesh.triangles);
  ASSERT_EQ(border.size(), 3U);
  for (const BorderEdge& edge : border) {
    EXPECT_EQ(edge.times, 1);
    bool back = false;  // the border runs against what is missing
    for (int k = 0; k < 3; ++k) back |= gone[k] == edge.to && gone[(k + 1) % 3] == edge.from;
    EXPECT_TRUE(back);
  }
  mesh.triangles.push_back({gone[0], gone[2], gone[1]});  // the wrong way round: twice the border
  for (const BorderEdge& edge : border_of(mesh.triangles)) EXPECT_EQ(edge.times, 2);
  EXPECT_EQ(build_topology(mesh).unbalanced_edges, 3U);
  EXPECT_FALSE(build_topology(mesh).closed());
}

TEST(Inside, ASmallHoleLeavesTheRestItsInside) {
  TriangleMesh mesh = box({10, 10, 10}, Vec3::Zero(), 40);
  mesh.triangles.pop_back();
  const Solid solid(mesh);
  EXPECT_FALSE(solid.topology().closed());
  ASSERT_TRUE(solid.has_inside());
  EXPECT_FALSE(solid.inside_known());
  ASSERT_EQ(solid.cracks().count, 1U);
  EXPECT_LT(solid.cracks().lids[0].reach_mm, 1.0);
  const TriangleMesh whole = box({10, 10, 10});
  std::mt19937_64 random(55);
  std::uniform_real_distribution<double> uniform(-12.0, 12.0);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    if (solid.cracks().cover(x)) continue;
    EXPECT_EQ(inside(solid, x), winding_number_brute_force(whole, x) > 0.5) << x.transpose();
  }
}

TEST(Inside, ASeamIsUnknownOnlyBesideIt) {
  // One corner of the triangles on one side of an edge is off by a hundredth: a crack as long as
  // the edge, and that wide.
  TriangleMesh mesh = box({10, 10, 10});
  const auto far = static_cast<std::uint32_t>(mesh.points_mm.size());
  const std::uint32_t moved = mesh.triangles[0][0];
  mesh.points_mm.push_back(mesh.points_mm[moved] * 0.999);
  mesh.triangles[0][0] = far;
  const Solid solid(mesh);
  ASSERT_TRUE(solid.has_inside());
  ASSERT_FALSE(solid.inside_known());
  std::mt19937_64 random(56);
  std::uniform_real_distribution<double> uniform(-12.0, 12.0);
  int covered = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    covered += solid.cracks().cover(x);
    if (solid.cracks().cover(x) || std::fabs(x.cwiseAbs().maxCoeff() - 10.0) < 0.02) continue;
    EXPECT_EQ(inside(solid, x), x.cwiseAbs().maxCoeff() < 10.0) << x.transpose();
  }
  EXPECT_LT(covered, 50);
}

TEST(Inside, ABoxWithoutALidHasNone) {
  TriangleMesh mesh = box({10, 10, 10});
  mesh.triangles.resize(mesh.triangles.size() - 2);
  EXPECT_FALSE(Solid(mesh).has_inside());
}

TEST(Inside, AllTrianglesOfACrowdedEdgeAreFound) {
  const TriangleMesh mesh = welded(together(box({1, 1, 1}), box({1, 1, 1}, {2, 2, 0})));
  const Topology topology = build_topology(mesh);
  int crowded = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      int across = 0;
      topology.each_across(t, k, [&](std::uint32_t other) {
        EXPECT_NE(other, t);
        ++across;
      });
      EXPECT_EQ(across, topology.edge_kind[t][k] == EdgeKind::kNonManifold ? 3 : 1);
      crowded += across == 3;
    }
  EXPECT_EQ(crowded, 4);
}

}  // namespace
}  // namespace mortise
