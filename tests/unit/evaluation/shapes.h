#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise::shapes {

/// Closed tube or rod about z from 0 to length with n facets, corners on the radii exactly. A
/// negative inner radius: a rod. phase turns the first corner.
inline TriangleMesh turned(double outer_mm, double inner_mm, double length_mm, int n,
                           double phase_rad = 0.0) {
  TriangleMesh mesh;
  const auto ring = [&](double r, double z) {
    const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
    for (int i = 0; i < n; ++i) {
      const double a = phase_rad + 2.0 * std::numbers::pi * i / n;
      mesh.points_mm.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
    return first;
  };
  const auto wall = [&](std::uint32_t from, std::uint32_t to) {
    for (int i = 0; i < n; ++i) {
      const std::uint32_t a = from + i, b = from + (i + 1) % n, c = to + (i + 1) % n, d = to + i;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  };
  const std::uint32_t bottom = ring(outer_mm, 0.0), top = ring(outer_mm, length_mm);
  wall(bottom, top);
  if (inner_mm > 0.0) {
    const std::uint32_t in_bottom = ring(inner_mm, 0.0), in_top = ring(inner_mm, length_mm);
    wall(in_top, in_bottom);
    wall(in_bottom, bottom);
    wall(top, in_top);
  } else {
    for (int i = 1; i + 1 < n; ++i) {
      mesh.triangles.push_back({bottom, bottom + i + 1, bottom + i});
      mesh.triangles.push_back({top, top + i, top + i + 1});
    }
  }
  return mesh;
}

/// Axis-parallel block around the origin.
inline TriangleMesh block(double x_mm, double y_mm, double z_mm) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points_mm.emplace_back((i & 1 ? 0.5 : -0.5) * x_mm, (i & 2 ? 0.5 : -0.5) * y_mm,
                                (i & 4 ? 0.5 : -0.5) * z_mm);
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

}  // namespace mortise::shapes
