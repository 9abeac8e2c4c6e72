#include "common/geometry/shells.h"

#include <algorithm>
#include <numeric>

#include "common/base/check.h"
#include "common/base/union_find.h"

namespace mortise {

std::vector<std::uint32_t> first_triangle_of_each_shell(const TriangleMesh& mesh) {
  MORTISE_CHECK(valid(mesh), "indices must name points, coordinates must be finite");
  const std::vector<Vec3>& points = mesh.points_mm;
  std::vector<std::uint32_t> by_place(points.size());
  std::iota(by_place.begin(), by_place.end(), 0U);
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t i, std::uint32_t j) {
    for (int c = 0; c < 3; ++c)
      if (points[i][c] != points[j][c]) return points[i][c] < points[j][c];
    return i < j;
  });
  UnionFind shells(points.size());
  for (std::size_t k = 1; k < by_place.size(); ++k)
    if (points[by_place[k]] == points[by_place[k - 1]]) shells.join(by_place[k], by_place[k - 1]);
  for (const auto& triangle : mesh.triangles) {
    shells.join(triangle[0], triangle[1]);
    shells.join(triangle[0], triangle[2]);
  }
  std::vector<std::uint32_t> first;
  std::vector<bool> seen(points.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t shell = shells.leader_of(mesh.triangles[t][0]);
    if (!seen[shell]) first.push_back(t);
    seen[shell] = true;
  }
  return first;
}

}  // namespace mortise
