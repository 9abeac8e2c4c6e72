#include "common/geometry/topology.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include "common/math/rotation.h"

namespace mortise {
namespace {

/// A prism over a polygon (counter-clockwise, star-shaped about its first corner), from z = 0 to
/// `height_mm`.
TriangleMesh prism(const std::vector<Vec3>& outline, double height_mm) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const Vec3& p : outline) mesh.points_mm.push_back(p);
  for (const Vec3& p : outline) mesh.points_mm.push_back(p + Vec3(0, 0, height_mm));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({n, n + i, n + i + 1});
  }
  return mesh;
}

TriangleMesh cube() { return prism({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 1.0); }

TriangleMesh cylinder(int facets) {
  std::vector<Vec3> outline;
  for (int i = 0; i < facets; ++i) {
    const double a = 2.0 * std::numbers::pi * i / facets;
    outline.push_back({10.0 * std::cos(a), 10.0 * std::sin(a), 0.0});
  }
  return prism(outline, 20.0);
}

/// Sides (two an edge) of each kind, indexed by EdgeKind.
std::array<int, 5> sides_by_kind(const Topology& topology) {
  std::array<int, 5> count{};
  for (const auto& kinds : topology.edge_kind)
    for (const EdgeKind kind : kinds) ++count[static_cast<std::size_t>(kind)];
  return count;
}

int sharp_sides(const Topology& topology) {
  int count = 0;
  for (const auto& sharp : topology.edge_sharp)
    for (const bool s : sharp) count += s ? 1 : 0;
  return count;
}

void expect_same(const Topology& a, const Topology& b) {
  EXPECT_EQ(a.neighbor, b.neighbor);
  EXPECT_EQ(a.edge_kind, b.edge_kind);
  EXPECT_EQ(a.edge_sharp, b.edge_sharp);
  EXPECT_EQ(a.boundary_edges, b.boundary_edges);
  EXPECT_EQ(a.non_manifold_edges, b.non_manifold_edges);
  EXPECT_EQ(a.misoriented_edges, b.misoriented_edges);
  EXPECT_EQ(a.components, b.components);
}

TEST(Topology, CubeHasTwelveConvexSharpEdges) {
  const Topology topology = build_topology(cube());
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1U);
  EXPECT_DOUBLE_EQ(topology.volume_mm3, 1.0);
  EXPECT_EQ(sides_by_kind(topology), (std::array<int, 5>{0, 12, 24, 0, 0}));
  EXPECT_EQ(sharp_sides(topology), 24);
}

TEST(Topology, LShapeHasOneConcaveEdge) {
  const TriangleMesh mesh = prism({{1, 1, 0}, {0, 3, 0}, {0, 0, 0}, {3, 0, 0}, {3, 1, 0}}, 1.0);
  const Topology topology = build_topology(mesh);
  ASSERT_TRUE(topology.closed());
  EXPECT_EQ(sides_by_kind(topology)[static_cast<std::size_t>(EdgeKind::kConcave)], 2);
}

TEST(Topology, ACavityIsConcaveAllOver) {
  // A cube with a smaller cube, turned inside out, in it: two components, volume 8 - 1.
  TriangleMesh mesh = cube();
  for (Vec3& p : mesh.points_mm) p = 2.0 * p;
  const TriangleMesh inner = cube();
  for (const Vec3& p : inner.points_mm) mesh.points_mm.push_back(p + Vec3(0.5, 0.5, 0.5));
  for (const auto& t : inner.triangles) mesh.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  const Topology topology = build_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 2U);
  EXPECT_NEAR(topology.volume_mm3, 7.0, 1e-12);
  EXPECT_EQ(sides_by_kind(topology), (std::array<int, 5>{0, 24, 24, 24, 0}));
}

TEST(Topology, FacetsOfACylinderAreSharpOnlyWhenCoarse) {
  EXPECT_EQ(sharp_sides(build_topology(cylinder(32))), 2 * 64);         // the two rims only
  EXPECT_EQ(sharp_sides(build_topology(cylinder(10))), 2 * (20 + 10));  // 36 degrees an edge
}

TEST(Topology, SameUnderMotionAndScale) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Topology reference = build_topology(cylinder(24));
  for (const double scale : {1e-4, 1e-2, 1.0, 1e2, 1e4})
    for (int i = 0; i < 20; ++i) {
      TriangleMesh mesh = cylinder(24);
      const auto direction = [&] {
        return Vec3(uniform(random), uniform(random), uniform(random));
      };
      const Pose X{rotation_exp(3.0 * direction()), 1000.0 * scale * direction()};
      for (Vec3& p : mesh.points_mm) p = X * (scale * p);
      const Topology topology = build_topology(mesh);
      ASSERT_TRUE(topology.closed());
      ASSERT_EQ(topology.edge_kind, reference.edge_kind) << "scale " << scale;
      ASSERT_EQ(topology.edge_sharp, reference.edge_sharp) << "scale " << scale;
      ASSERT_NEAR(topology.volume_mm3 / (scale * scale * scale), reference.volume_mm3, 1e-6);
    }
}

TEST(Topology, CountsWhatIsWrong) {
  TriangleMesh open = cube();
  open.triangles.pop_back();
  const Topology without_one = build_topology(open);
  EXPECT_EQ(without_one.boundary_edges, 3U);
  EXPECT_FALSE(without_one.closed());

  TriangleMesh turned = cube();
  std::swap(turned.triangles[3][1], turned.triangles[3][2]);
  EXPECT_EQ(build_topology(turned).misoriented_edges, 3U);
  EXPECT_EQ(build_topology(turned).boundary_edges, 0U);

  TriangleMesh fin = cube();
  fin.points_mm.push_back({0.5, -1.0, -1.0});
  fin.triangles.push_back({0, 1, 8});
  const Topology with_fin = build_topology(fin);
  EXPECT_EQ(with_fin.non_manifold_edges, 1U);
  EXPECT_EQ(with_fin.boundary_edges, 2U);

  TriangleMesh inside_out = cube();
  for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
  EXPECT_LT(build_topology(inside_out).volume_mm3, 0.0);
  EXPECT_FALSE(build_topology(inside_out).closed());

  TriangleMesh collapsed = cube();
  collapsed.triangles.push_back({2, 2, 5});
  EXPECT_GT(build_topology(collapsed).non_manifold_edges, 0U);
  EXPECT_EQ(build_topology(TriangleMesh{}).components, 0U);
}

TEST(Topology, AgreesWithTheSlowTwin) {
  std::mt19937_64 random(42);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh mesh;
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 9; ++i)
      mesh.points_mm.push_back({uniform(random), uniform(random), uniform(random)});
    std::uniform_int_distribution<std::uint32_t> index(0, 8);
    for (int i = 0; i < 3 + round % 40; ++i)
      mesh.triangles.push_back({index(random), index(random), index(random)});
    expect_same(build_topology(mesh), build_topology_brute_force(mesh));
  }
  expect_same(build_topology(cylinder(40)), build_topology_brute_force(cylinder(40)));
}

TEST(Topology, TwoHundredThousandTrianglesInAThirdOfASecond) {
  // A torus grid of 364 x 364 quads: 264,992 triangles.
  constexpr std::uint32_t kSide = 364;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const double u = 2.0 * std::numbers::pi * i / kSide;
      const double v = 2.0 * std::numbers::pi * j / kSide;
      const double r = 50.0 + 20.0 * std::cos(v);
      mesh.points_mm.push_back({r * std::cos(u), r * std::sin(u), 20.0 * std::sin(v)});
    }
  const auto at = [](std::uint32_t i, std::uint32_t j) { return i % kSide * kSide + j % kSide; };
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (std::uint32_t j = 0; j < kSide; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  const auto start = std::chrono::steady_clock::now();
  const Topology topology = build_topology(mesh);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1U);
  RecordProperty("milliseconds", static_cast<int>(1000.0 * seconds));
  std::printf("%zu triangles in %.3f s\n", mesh.triangles.size(), seconds);
}

}  // namespace
}  // namespace mortise
