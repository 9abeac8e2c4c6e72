#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <random>

#include "common/geometry/mesh.h"

namespace mortise::shapes {

/// The same surface with `count` more corners: edges drawn at random are split at a random place,
/// the two triangles of each with them. Closed stays closed; slivers come about as they do in
/// files. O(count * triangles).
inline TriangleMesh refined(TriangleMesh mesh, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.1, 0.9);
  for (int i = 0; i < count; ++i) {
    const auto t = std::uniform_int_distribution<std::size_t>(0, mesh.triangles.size() - 1)(random);
    const auto k = std::uniform_int_distribution<std::size_t>(0, 2)(random);
    const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
    const double u = share(random);
    const auto middle = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.points_mm.push_back((1.0 - u) * mesh.points_mm[a] + u * mesh.points_mm[b]);
    const std::size_t before = mesh.triangles.size();
    for (std::size_t j = 0; j < before; ++j)
      for (std::size_t e = 0; e < 3; ++e) {
        auto& triangle = mesh.triangles[j];
        const std::uint32_t p = triangle[e], q = triangle[(e + 1) % 3], r = triangle[(e + 2) % 3];
        if (!((p == a && q == b) || (p == b && q == a))) continue;
        triangle = {p, middle, r};
        mesh.triangles.push_back({middle, q, r});
        break;
      }
  }
  return mesh;
}

}  // namespace mortise::shapes
