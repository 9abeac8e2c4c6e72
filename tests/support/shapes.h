#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "common/geometry/solid.h"
#include "common/math/pose.h"
#include "common/math/rotation.h"

/// Small exact meshes for tests: closed, outward oriented, welded.
namespace mortise::shapes {

inline void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                     std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// Axis-aligned box; every face n x n squares of two triangles: 12 n^2 triangles.
inline TriangleMesh box(const Vec3& half_mm, const Vec3& center_mm = Vec3::Zero(), int n = 1) {
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto point = [&](const std::array<int, 3>& grid) {
    const auto [at, fresh] = index.try_emplace(grid, mesh.points_mm.size());
    if (fresh) {
      Vec3 x;
      for (int c = 0; c < 3; ++c) x[c] = center_mm[c] + half_mm[c] * (2.0 * grid[c] / n - 1.0);
      mesh.points_mm.push_back(x);
    }
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> grid{};
            grid[axis] = side;
            grid[u] = i + di;
            grid[v] = j + dj;
            return point(grid);
          };
          if (side == n)
            add_quad(mesh, corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
          else
            add_quad(mesh, corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
        }
    }
  return mesh;
}

struct Round {
  double radius_mm = 10.0;
  double z0_mm = 0.0, z1_mm = 20.0;
  int n = 32;              ///< corners of the polygon, all on the circle
  int rows = 1;            ///< along z
  double phase_rad = 0.0;  ///< of the first corner
};

inline Vec3 on_circle(double radius_mm, double angle_rad, double z_mm) {
  return {radius_mm * std::cos(angle_rad), radius_mm * std::sin(angle_rad), z_mm};
}

/// Solid polygonal cylinder along z.
inline TriangleMesh peg(const Round& r) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(r.n), rows = static_cast<std::uint32_t>(r.rows);
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i < n; ++i)
      mesh.points_mm.push_back(on_circle(r.radius_mm, 2.0 * std::numbers::pi * i / n + r.phase_rad,
                                         r.z0_mm + (r.z1_mm - r.z0_mm) * j / rows));
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = (i + 1) % n;
      add_quad(mesh, j * n + i, j * n + k, (j + 1) * n + k, (j + 1) * n + i);
    }
  const auto bottom = static_cast<std::uint32_t>(mesh.points_mm.size());
  mesh.points_mm.push_back(Vec3(0, 0, r.z0_mm));
  mesh.points_mm.push_back(Vec3(0, 0, r.z1_mm));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t k = (i + 1) % n;
    mesh.triangles.push_back({bottom, k, i});
    mesh.triangles.push_back({bottom + 1, rows * n + i, rows * n + k});
  }
  return mesh;
}

/// Ring around a polygonal hole of the Round, out to outer_radius_mm (same corners angles).
inline TriangleMesh ring(const Round& r, double outer_radius_mm) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(r.n), rows = static_cast<std::uint32_t>(r.rows);
  for (const double radius : {r.radius_mm, outer_radius_mm})
    for (std::uint32_t j = 0; j <= rows; ++j)
      for (std::uint32_t i = 0; i < n; ++i)
        mesh.points_mm.push_back(on_circle(radius, 2.0 * std::numbers::pi * i / n + r.phase_rad,
                                           r.z0_mm + (r.z1_mm - r.z0_mm) * j / rows));
  const std::uint32_t outer = (rows + 1) * n, top = rows * n;
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = (i + 1) % n, a = j * n + i, b = j * n + k, c = a + n, d = b + n;
      add_quad(mesh, a, c, d, b);
      add_quad(mesh, outer + a, outer + b, outer + d, outer + c);
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t k = (i + 1) % n;
    add_quad(mesh, i, k, outer + k, outer + i);
    add_quad(mesh, top + i, outer + top + i, outer + top + k, top + k);
  }
  return mesh;
}

/// Sphere of n x 2n facets by latitude and longitude, corners on the sphere.
inline TriangleMesh sphere(double radius_mm, const Vec3& center_mm = Vec3::Zero(), int n = 16) {
  TriangleMesh mesh;
  const auto rows = static_cast<std::uint32_t>(n), columns = 2 * rows;
  mesh.points_mm.push_back(center_mm + Vec3(0, 0, -radius_mm));
  for (std::uint32_t i = 1; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double u = std::numbers::pi * i / rows - 0.5 * std::numbers::pi;
      mesh.points_mm.push_back(center_mm + on_circle(radius_mm * std::cos(u),
                                                     2.0 * std::numbers::pi * j / columns,
                                                     radius_mm * std::sin(u)));
    }
  const auto top = static_cast<std::uint32_t>(mesh.points_mm.size());
  mesh.points_mm.push_back(center_mm + Vec3(0, 0, radius_mm));
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return 1 + (i - 1) * columns + j % columns;
  };
  for (std::uint32_t j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j + 1), at(1, j)});
    mesh.triangles.push_back({top, at(rows - 1, j), at(rows - 1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rows; ++i)
      add_quad(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  }
  return mesh;
}

/// A polygon in the xy plane, counter-clockwise, star-shaped about `middle_mm` is not needed: cut
/// into the given triangles, drawn out along z.
inline TriangleMesh prism(const std::vector<std::array<double, 2>>& polygon,
                          const std::vector<std::array<std::uint32_t, 3>>& cut, double z0_mm,
                          double z1_mm) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (const double z : {z0_mm, z1_mm})
    for (const auto& p : polygon) mesh.points_mm.push_back(Vec3(p[0], p[1], z));
  for (const auto& t : cut) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t k = (i + 1) % n;
    add_quad(mesh, i, k, n + k, n + i);
  }
  return mesh;
}

/// Block of outer half width w with a slot of half width s open upwards (y), bottom of the slot at
/// y = 0, walls up to y = h, along z.
inline TriangleMesh u_slot(double w_mm, double s_mm, double h_mm, double floor_mm, double z0_mm,
                           double z1_mm) {
  return prism({{-w_mm, -floor_mm},
                {w_mm, -floor_mm},
                {w_mm, h_mm},
                {s_mm, h_mm},
                {s_mm, 0.0},
                {-s_mm, 0.0},
                {-s_mm, h_mm},
                {-w_mm, h_mm}},
               {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}}, z0_mm, z1_mm);
}

/// Two meshes as one part.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto base = static_cast<std::uint32_t>(a.points_mm.size());
  a.points_mm.insert(a.points_mm.end(), b.points_mm.begin(), b.points_mm.end());
  for (const auto& t : b.triangles) a.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  return a;
}

inline TriangleMesh scaled(TriangleMesh mesh, double factor) {
  for (Vec3& x : mesh.points_mm) x *= factor;
  return mesh;
}

inline SolidPtr solid(TriangleMesh mesh) { return std::make_shared<Solid>(std::move(mesh)); }

/// A rigid motion from a seeded generator: any rotation, shift up to `reach_mm` per axis.
inline Pose random_pose(std::mt19937_64& random, double reach_mm) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vec3 w;
  do w = Vec3(unit(random), unit(random), unit(random));
  while (w.squaredNorm() > 1.0);
  const Vec3 shift(unit(random), unit(random), unit(random));
  return {rotation_exp(std::numbers::pi * w), reach_mm * shift};
}

}  // namespace mortise::shapes
