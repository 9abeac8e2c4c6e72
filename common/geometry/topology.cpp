#include "common/geometry/topology.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/base/union_find.h"

namespace mortise {
namespace {

/// A corner that lies off the plane of the neighbour by less than this part of the longest edge
/// counts as in the plane (README, section 1). Scale-free; far above rounding, far below any drawn
/// chamfer.
constexpr double kFlatEdge = 1e-9;

/// Which way an edge is passed by one triangle.
struct Side {
  std::uint32_t high;  ///< the larger point index of the edge; the smaller one names the bucket
  std::uint32_t id;    ///< 3 * triangle + edge
  bool forward;        ///< from the smaller index to the larger
};

/// Twice the area vector of a triangle.
Vec3 area_vector(const TriangleMesh& mesh, std::uint32_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}

struct EdgeShape {
  EdgeKind kind = EdgeKind::kFlat;
  bool sharp = false;
};

/// Dihedral of edge `k` of triangle `t` with its neighbour `u`, whose corner off the edge is
/// `across`. Symmetric in both triangles up to rounding; called once an edge.
EdgeShape shape_of_edge(const TriangleMesh& mesh, double extent_mm, std::uint32_t t, int k,
                        std::uint32_t u, int across) {
  const Vec3 normal_t = area_vector(mesh, t);
  const Vec3 normal_u = area_vector(mesh, u);
  const double length_t = normal_t.norm();
  const double length_u = normal_u.norm();
  if (length_t == 0.0 || length_u == 0.0) return {};  // a sliver bends nothing
  const Vec3& start = mesh.corner(t, k);
  const Vec3& end = mesh.corner(t, (k + 1) % 3);
  const Vec3 beyond = mesh.corner(u, across) - start;
  const Vec3 before = mesh.corner(t, (k + 2) % 3) - start;
  const double size = std::sqrt(
      std::max({(end - start).squaredNorm(), beyond.squaredNorm(), before.squaredNorm()}));
  const double epsilon_mm = kRoundingFactor * kUnitRoundoff * extent_mm;
  const double height_mm = normal_t.dot(beyond) / length_t;
  EdgeShape shape;
  const double exterior_rad = std::atan2(normal_t.cross(normal_u).norm(), normal_t.dot(normal_u));
  shape.sharp = exterior_rad > kSharpEdge_rad;
  if (std::abs(height_mm) > kFlatEdge * size + epsilon_mm)
    shape.kind = height_mm < 0.0 ? EdgeKind::kConvex : EdgeKind::kConcave;
  else if (shape.sharp)
    shape.kind = EdgeKind::kConvex;  // folded back onto itself: a blade of no thickness
  return shape;
}

Vec3 normal_of(const TriangleMesh& mesh, std::uint32_t t) {
  const Vec3 n =
      (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : Vec3::Zero();
}

Topology without_edges(const TriangleMesh& mesh) {
  Topology topology;
  const std::size_t count = mesh.triangles.size();
  topology.neighbor.assign(count, {Topology::kNone, Topology::kNone, Topology::kNone});
  topology.edge_kind.assign(count, {EdgeKind::kBoundary, EdgeKind::kBoundary, EdgeKind::kBoundary});
  topology.edge_sharp.assign(count, {false, false, false});
  topology.normal.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) topology.normal.push_back(normal_of(mesh, t));
  topology.volume_mm3 = signed_volume_mm3(mesh);
  return topology;
}

double extent_of(const TriangleMesh& mesh) {
  double extent_mm = 0.0;
  for (const Vec3& point : mesh.points_mm)
    extent_mm = std::max(extent_mm, point.cwiseAbs().maxCoeff());
  return extent_mm;
}

/// Writes down one edge: `sides` are all triangles that have it.
void record_edge(const TriangleMesh& mesh, double extent_mm, const Side* sides, std::size_t count,
                 bool no_length, Topology& topology) {
  const auto forward = static_cast<std::size_t>(
      std::count_if(sides, sides + count, [](const Side& side) { return side.forward; }));
  if (no_length || 2 * forward != count) ++topology.unbalanced_edges;
  const auto triangle = [&](std::size_t i) { return sides[i].id / 3; };
  const auto edge = [&](std::size_t i) { return static_cast<int>(sides[i].id % 3); };
  if (no_length || count > 2) {
    ++topology.non_manifold_edges;
    for (std::size_t i = 0; i < count; ++i)
      topology.edge_kind[triangle(i)][edge(i)] = EdgeKind::kNonManifold;
    for (std::size_t i = 0; i < count && count > 2; ++i)
      topology.next_side[sides[i].id] = sides[(i + 1) % count].id;
    return;
  }
  if (count == 1) {
    ++topology.boundary_edges;
    return;
  }
  topology.neighbor[triangle(0)][edge(0)] = triangle(1);
  topology.neighbor[triangle(1)][edge(1)] = triangle(0);
  EdgeShape shape{EdgeKind::kNonManifold, true};
  if (sides[0].forward == sides[1].forward)
    ++topology.misoriented_edges;
  else
    shape = shape_of_edge(mesh, extent_mm, triangle(0), edge(0), triangle(1), (edge(1) + 2) % 3);
  for (std::size_t i = 0; i < 2; ++i) {
    topology.edge_kind[triangle(i)][edge(i)] = shape.kind;
    topology.edge_sharp[triangle(i)][edge(i)] = shape.sharp;
  }
}

/// The corners of triangles at one point fall into fans, connected across edges of two triangles.
std::uint64_t count_pinched_points(const TriangleMesh& mesh, const Topology& topology) {
  UnionFind corners(3 * mesh.triangles.size());
  const auto corner_at = [&](std::uint32_t t, std::uint32_t point) {
    std::uint32_t k = 0;
    while (k < 2 && mesh.triangles[t][k] != point) ++k;
    return 3 * t + k;
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (const std::uint32_t other = topology.neighbor[t][k]; other != Topology::kNone)
        for (const std::uint32_t at : {k, (k + 1) % 3})
          corners.join(3 * t + at, corner_at(other, mesh.triangles[t][at]));
  std::vector<std::uint32_t> fans(mesh.points_mm.size(), 0);
  for (std::uint32_t i = 0; i < corners.size(); ++i)
    if (corners.leads(i)) ++fans[mesh.triangles[i / 3][i % 3]];
  return static_cast<std::uint64_t>(
      std::count_if(fans.begin(), fans.end(), [](std::uint32_t n) { return n > 1; }));
}

}  // namespace

Topology build_topology(const TriangleMesh& mesh) {
  MORTISE_CHECK(valid(mesh), "indices must name points, coordinates must be finite");
  Topology topology = without_edges(mesh);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const double extent_mm = extent_of(mesh);

  // 1. All sides of all triangles, bucketed by the smaller point index (counting sort).
  std::vector<std::uint32_t> begin(mesh.points_mm.size() + 1, 0);
  for (const auto& corners : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++begin[std::min(corners[k], corners[(k + 1) % 3]) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Side> sides(3 * static_cast<std::size_t>(count));
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k];
      const std::uint32_t to = mesh.triangles[t][(k + 1) % 3];
      sides[next[std::min(from, to)]++] = {std::max(from, to), 3 * t + k, from < to};
    }

  // 2. Within a bucket the sides of one edge stand together; ties by triangle.
  UnionFind components(count);
  for (std::uint32_t low = 0; low < mesh.points_mm.size(); ++low) {
    const auto first = sides.begin() + begin[low];
    const auto last = sides.begin() + begin[low + 1];
    std::sort(first, last, [](const Side& a, const Side& b) {
      return a.high != b.high ? a.high < b.high : a.id < b.id;
    });
    for (auto run = first; run != last;) {
      auto end = run;
      while (end != last && end->high == run->high) components.join(run->id / 3, (end++)->id / 3);
      record_edge(mesh, extent_mm, &*run, static_cast<std::size_t>(end - run), run->high == low,
                  topology);
      run = end;
    }
  }
  topology.components = components.count_sets();
  topology.pinched_points = count_pinched_points(mesh, topology);
  return topology;
}

Topology build_topology_brute_force(const TriangleMesh& mesh) {
  MORTISE_CHECK(valid(mesh), "indices must name points, coordinates must be finite");
  Topology topology = without_edges(mesh);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const double extent_mm = extent_of(mesh);
  UnionFind components(count);
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k];
      const std::uint32_t to = mesh.triangles[t][(k + 1) % 3];
      std::vector<Side> same;
      for (std::uint32_t id = 0; id < 3 * count; ++id) {
        const std::uint32_t a = mesh.triangles[id / 3][id % 3];
        const std::uint32_t b = mesh.triangles[id / 3][(id % 3 + 1) % 3];
        if (std::min(a, b) == std::min(from, to) && std::max(a, b) == std::max(from, to))
          same.push_back({std::max(a, b), id, a < b});
      }
      if (same.front().id != 3 * t + k) continue;  // recorded when its first side came
      for (const Side& side : same) components.join(t, side.id / 3);
      record_edge(mesh, extent_mm, same.data(), same.size(), from == to, topology);
    }
  topology.components = components.count_sets();
  topology.pinched_points = count_pinched_points(mesh, topology);
  return topology;
}

}  // namespace mortise
