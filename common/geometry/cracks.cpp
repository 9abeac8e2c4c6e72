#include "common/geometry/cracks.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "common/base/union_find.h"
#include "common/geometry/border.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

/// A crack that is wider than this share of the part is a hole.
constexpr double kLargestShare = 0.1;

/// Every lid is asked by every ray. More edges than that are cut off by a cone.
constexpr std::size_t kMostLids = 4000, kMostEars = 1000;

using Corners = std::array<Vec3, 3>;

double area_of(const Corners& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm(); }

/// The points of a border in the order in which it passes them; nothing where it branches.
std::optional<std::vector<std::uint32_t>> loop_of(const std::vector<BorderEdge>& edges) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (const BorderEdge& edge : edges)
    if (edge.times != 1 || !next.emplace(edge.from, edge.to).second) return std::nullopt;
  std::vector<std::uint32_t> loop{edges.front().from};
  for (std::uint32_t at = next.at(loop[0]); at != loop[0]; at = next.at(at)) {
    if (loop.size() == edges.size() || next.find(at) == next.end()) return std::nullopt;
    loop.push_back(at);
  }
  if (loop.size() != edges.size()) return std::nullopt;
  return loop;
}

/// Ears of least area first: two sides of a seam are sewn together, whatever its course.
void sew(const TriangleMesh& mesh, std::vector<std::uint32_t> loop, std::vector<Corners>& lids) {
  const auto ear = [&](std::size_t i) {
    const std::size_t n = loop.size();
    return Corners{mesh.points_mm[loop[(i + 1) % n]], mesh.points_mm[loop[i]],
                   mesh.points_mm[loop[(i + n - 1) % n]]};
  };
  while (loop.size() > 2) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (const double area = area_of(ear(i)); area < least) {
        least = area;
        best = i;
      }
    lids.push_back(ear(best));
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

/// A border has no end, so the sides of the cone cancel each other.
void cover_with_cone(const TriangleMesh& mesh, const std::vector<BorderEdge>& edges,
                     const Vec3& tip, std::vector<Corners>& lids) {
  for (const BorderEdge& edge : edges)
    for (std::int32_t i = 0; i < edge.times; ++i)
      lids.push_back({mesh.points_mm[edge.to], mesh.points_mm[edge.from], tip});
}

void close_crack(const TriangleMesh& mesh, const std::vector<BorderEdge>& edges, Cracks& cracks) {
  Vec3 middle = Vec3::Zero();
  for (const BorderEdge& edge : edges)
    middle += mesh.points_mm[edge.from] / static_cast<double>(edges.size());
  double radius_mm = 0.0, area_mm2 = 0.0;
  for (const BorderEdge& edge : edges)
    radius_mm = std::max(radius_mm, (mesh.points_mm[edge.from] - middle).norm());
  std::vector<Corners> lids;
  const auto loop = edges.size() <= kMostEars ? loop_of(edges) : std::nullopt;
  if (loop)
    sew(mesh, *loop, lids);
  else
    cover_with_cone(mesh, edges, middle, lids);
  for (const Corners& lid : lids) area_mm2 += area_of(lid);
  // Of a strip this is its width, of a round hole three times its radius.
  const double width_mm = radius_mm > 0.0 ? area_mm2 / radius_mm : 0.0;
  for (const Corners& lid : lids) cracks.lids.push_back({lid, cracks.count, width_mm});
  ++cracks.count;
}

}  // namespace

bool Cracks::cover(const Vec3& x) const {
  return std::any_of(lids.begin(), lids.end(), [&](const Lid& lid) {
    const Vec3 foot = nearest_on_triangle(x, lid.corners[0], lid.corners[1], lid.corners[2]);
    return (foot - x).norm() <= lid.reach_mm;
  });
}

Cracks find_cracks(const TriangleMesh& mesh) {
  const std::vector<BorderEdge> border = border_of(mesh.triangles);
  UnionFind loops(border.empty() ? 0 : mesh.points_mm.size());
  for (const BorderEdge& edge : border) loops.join(edge.from, edge.to);
  std::map<std::uint32_t, std::vector<BorderEdge>> pieces;
  for (const BorderEdge& edge : border) pieces[loops.leader_of(edge.from)].push_back(edge);
  Cracks cracks;
  for (const auto& [first, edges] : pieces) close_crack(mesh, edges, cracks);
  return cracks;
}

bool small(const Cracks& cracks, double part_radius_mm) {
  return cracks.lids.size() <= kMostLids &&
         std::all_of(cracks.lids.begin(), cracks.lids.end(), [&](const Lid& lid) {
           return lid.reach_mm <= kLargestShare * part_radius_mm;
         });
}

}  // namespace mortise
