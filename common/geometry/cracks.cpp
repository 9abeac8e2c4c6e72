#include "common/geometry/cracks.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>

#include "common/geometry/border.h"

namespace mortise {
namespace {

/// At twice the radius of a ball no flat lid in it fills more than a fifteenth of the sky.
constexpr double kCrackReach = 2.0;

/// Larger than this share of the part a hole is no crack.
constexpr double kLargestShare = 0.1;

/// Every lid is asked by every ray.
constexpr std::size_t kMostLids = 4000;

}  // namespace

bool Cracks::cover(const Vec3& x) const {
  return std::any_of(all.begin(), all.end(), [&](const Crack& crack) { return crack.covers(x); });
}

Cracks find_cracks(const TriangleMesh& mesh) {
  const std::vector<BorderEdge> border = border_of(mesh.triangles);
  // 1. Pieces of the border, connected by their points.
  std::vector<std::uint32_t> parent(border.empty() ? 0 : mesh.points_mm.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const BorderEdge& edge : border) {
    const std::uint32_t a = root(edge.from), b = root(edge.to);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::uint32_t, std::vector<BorderEdge>> pieces;
  for (const BorderEdge& edge : border) pieces[root(edge.from)].push_back(edge);
  // 2. A cone over each. A border has no end, so the sides of the cone cancel each other.
  Cracks cracks;
  for (const auto& [first, edges] : pieces) {
    Crack crack;
    for (const BorderEdge& edge : edges)
      crack.center_mm += mesh.points_mm[edge.from] / static_cast<double>(edges.size());
    for (const BorderEdge& edge : edges)
      for (const std::uint32_t point : {edge.from, edge.to})
        crack.reach_mm = std::max(crack.reach_mm,
                                  kCrackReach * (mesh.points_mm[point] - crack.center_mm).norm());
    for (const BorderEdge& edge : edges)
      for (std::int32_t i = 0; i < edge.times; ++i)
        cracks.lids.push_back(
            {mesh.points_mm[edge.to], mesh.points_mm[edge.from], crack.center_mm});
    cracks.all.push_back(crack);
  }
  return cracks;
}

bool small(const Cracks& cracks, double part_radius_mm) {
  return cracks.lids.size() <= kMostLids &&
         std::all_of(cracks.all.begin(), cracks.all.end(), [&](const Crack& crack) {
           return crack.reach_mm <= kLargestShare * part_radius_mm;
         });
}

}  // namespace mortise
