#include "common/geometry/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/geometry/bvh/bvh_support.h"

namespace mortise {
namespace {

// A mesh with no more points has all of them as corners of its outline.
constexpr std::size_t kFewPoints = 128;
// Directions along which the corners of a larger one are taken, beside 26 to the faces, edges and
// corners of a cube.
constexpr int kDirections = 96;
// Normals of the largest faces: a block has three lines of them, a prism of a triangle four.
constexpr std::size_t kMainNormals = 4;
// Two lines of normals are one when they differ by less (sine).
constexpr double kSameLine = 0.03;
// A mesh counts as nearly convex while it falls short of its hull by this share of its size.
constexpr double kMostSlackShare = 1e-3;
// Larger meshes are only asked whether they are convex to rounding, a share of the coordinates; the
// slack then stands for it.
constexpr std::size_t kManyTriangles = 4000;
constexpr double kConvexRounding = 1e-14, kLargeSlackShare = 1e-10;
// An edge that is hollow by this share of the size ends the question at once.
constexpr double kHollowShare = 1e-4;

// A spiral of even density around the sphere: each direction turned on by the golden angle.
std::vector<Vec3> directions() {
  // Of pi (3 - sqrt 5).
  constexpr double kCosGolden = -0.73736887807831985, kSinGolden = 0.67549029426152364;
  std::vector<Vec3> all;
  double c = 1.0, s = 0.0;
  for (int k = 0; k < kDirections; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / kDirections, u = std::sqrt(1.0 - z * z);
    all.push_back(Vec3(u * c, u * s, z));
    const double turned = c * kCosGolden - s * kSinGolden;
    s = s * kCosGolden + c * kSinGolden;
    c = turned;
  }
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
    if (i != 13) all.push_back(Vec3(x, y, z).normalized());
  }
  return all;
}

void add_corners(const TriangleMesh& mesh, const Bvh& bvh, Outline& outline) {
  std::vector<char> used(mesh.points_mm.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t p : triangle) used[p] = 1;
  std::vector<Vec3>& corners = outline.corners;
  const auto count = std::count(used.begin(), used.end(), 1);
  outline.complete = static_cast<std::size_t>(count) <= kFewPoints;
  if (outline.complete) {
    for (std::size_t p = 0; p < used.size(); ++p)
      if (used[p] != 0) corners.push_back(mesh.points_mm[p]);
    return;
  }
  for (const Vec3& n : directions()) {
    const Vec3 x = support(bvh, n, Support(), 0.0).point + bvh.origin;
    if (std::find(corners.begin(), corners.end(), x) == corners.end()) corners.push_back(x);
  }
}

Vec3 facet_area(const TriangleMesh& mesh, std::uint32_t t) {
  return 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}

// Normals whose coordinates round to the same cell are counted together, opposite ones as one.
void add_main_normals(const TriangleMesh& mesh, Outline& outline) {
  struct Cell {
    std::array<int, 3> key{};
    Vec3 sum = Vec3::Zero();
  };
  std::vector<Cell> cells;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3 area = facet_area(mesh, t);
    const double size = area.norm();
    if (!(size > 0.0)) continue;
    Cell cell;  // of the unit sphere, three degrees wide
    for (std::size_t k = 0; k < 3; ++k)
      cell.key[k] = static_cast<int>(std::lround(20.0 * area[static_cast<int>(k)] / size));
    if (cell.key < std::array<int, 3>{}) {
      area = -area;
      for (int& k : cell.key) k = -k;
    }
    cell.sum = area;
    cells.push_back(cell);
  }
  std::stable_sort(cells.begin(), cells.end(),
                   [](const Cell& x, const Cell& y) { return x.key < y.key; });
  std::size_t n = 0;
  for (const Cell& cell : cells)
    if (n > 0 && cells[n - 1].key == cell.key)
      cells[n - 1].sum += cell.sum;
    else
      cells[n++] = cell;
  cells.resize(n);
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& x, const Cell& y) {
    return x.sum.squaredNorm() > y.sum.squaredNorm();
  });
  std::vector<Vec3>& normals = outline.main_normals;
  for (const Cell& cell : cells) {
    if (normals.size() == kMainNormals) break;
    const Vec3 normal = cell.sum.stableNormalized();
    if (std::none_of(normals.begin(), normals.end(),
                     [&](const Vec3& other) { return other.cross(normal).norm() < kSameLine; }))
      normals.push_back(normal);
  }
}

// By how much a corner beside a corner lies above a facet there, over all facets, mm.
double above_beside(const TriangleMesh& mesh, const std::vector<Vec3>& normals) {
  std::vector<std::uint32_t> first(mesh.points_mm.size() + 1, 0), around;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t p : triangle) ++first[p + 1];
  for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
  around.resize(first.back());
  std::vector<std::uint32_t> at(first.begin(), first.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t p : mesh.triangles[t]) around[at[p]++] = t;
  double above_mm = 0.0;
  for (std::size_t p = 0; p + 1 < first.size(); ++p)
    for (std::uint32_t i = first[p]; i < first[p + 1]; ++i)
      for (std::uint32_t j = first[p]; j < first[p + 1]; ++j)
        for (int c = 0; c < 3; ++c)
          above_mm = std::max(
              above_mm, normals[around[i]].dot(mesh.corner(around[j], c) - mesh.points_mm[p]));
  return above_mm;
}

// 1. Some edge is plainly hollow: not convex.
// 2. A large mesh that is convex around each of its corners, to rounding, is convex: what is
// closed,
//    connected and locally convex bounds a convex body (van Heijenoort 1952).
// 3. Else: no corner of the mesh is more than `above` over the plane of any facet. So all of the
// hull,
//    shrunk towards a point that lies `inside_mm` below all planes by inside / (inside + above),
//    lies below all planes; and what is below all planes of a mesh belongs to it.
double convex_slack(const TriangleMesh& mesh, const Bvh& bvh, const Topology& topology,
                    const Outline& outline) {
  constexpr double kNo = std::numeric_limits<double>::infinity();
  const double hollow_mm = kHollowShare * bvh.radius_mm;
  if (!topology.closed() || topology.components != 1 || mesh.triangles.empty()) return kNo;
  std::vector<Vec3> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    normals[t] = facet_area(mesh, t).stableNormalized();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (topology.edge_kind[t][k] == EdgeKind::kNonManifold) return kNo;
      const std::uint32_t other = topology.neighbor[t][k];
      if (topology.edge_kind[t][k] != EdgeKind::kConcave || other == Topology::kNone) continue;
      for (int c = 0; c < 3; ++c)
        if (normals[t].dot(mesh.corner(other, c) - mesh.corner(t, 0)) > hollow_mm) return kNo;
    }
  if (mesh.triangles.size() > kManyTriangles) {
    const double rounding_mm = kConvexRounding * (bvh.radius_mm + bvh.extent_mm);
    return above_beside(mesh, normals) <= rounding_mm ? kLargeSlackShare * bvh.radius_mm : kNo;
  }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : outline.corners) middle += x / static_cast<double>(outline.corners.size());
  double above_mm = 0.0, inside_mm = kNo, radius_mm = 0.0;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t p : triangle)
      radius_mm = std::max(radius_mm, (mesh.points_mm[p] - middle).norm());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    // A unit vector, or zero of a triangle without an area.
    if (!(normals[t].squaredNorm() > 0.5)) continue;
    const Vec3 x = farthest_corner(bvh, outline, normals[t]);
    above_mm = std::max(above_mm, normals[t].dot(x - mesh.corner(t, 0)));
    inside_mm = std::min(inside_mm, normals[t].dot(mesh.corner(t, 0) - middle));
    if (above_mm > hollow_mm || !(inside_mm > 0.0)) return kNo;
  }
  const double slack_mm = above_mm / (inside_mm + above_mm) * radius_mm;
  return slack_mm <= kMostSlackShare * radius_mm ? slack_mm : kNo;
}

}  // namespace

Vec3 farthest_corner(const Bvh& bvh, const Outline& outline, const Vec3& n) {
  if (!outline.complete) return support(bvh, n, Support(), 0.0).point + bvh.origin;
  const Vec3* best = &outline.corners.front();
  double most = n.dot(*best);
  for (const Vec3& x : outline.corners)
    if (const double along = n.dot(x); along > most) {
      most = along;
      best = &x;
    }
  return *best;
}

Outline outline_of(const TriangleMesh& mesh, const Bvh& bvh, const Topology& topology) {
  Outline outline;
  if (mesh.triangles.empty()) return outline;
  add_corners(mesh, bvh, outline);
  add_main_normals(mesh, outline);
  outline.convex_slack_mm = convex_slack(mesh, bvh, topology, outline);
  return outline;
}

}  // namespace mortise
