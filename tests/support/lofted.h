#pragma once
#include <functional>

#include "tests/support/shapes.h"

namespace mortise::shapes {

/// Closed solid along z through rings of equally many corners, counterclockwise seen from +z. Both
/// flat ends are triangulated between corners of their rim only, as a fan.
inline TriangleMesh lofted(const std::vector<std::vector<Vec3>>& rings) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(rings.front().size());
  const auto last = static_cast<std::uint32_t>(rings.size() - 1) * n;
  for (const auto& ring : rings)
    mesh.points_mm.insert(mesh.points_mm.end(), ring.begin(), ring.end());
  for (std::uint32_t from = 0; from < last; from += n)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = (i + 1) % n;
      add_quad(mesh, from + i, from + k, from + n + k, from + n + i);
    }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({last, last + i, last + i + 1});
  }
  return mesh;
}

/// A plate of the thickness with a hole of the section (corners at z = 0, counterclockwise); its
/// outer border is the section `times` as large.
inline TriangleMesh plate_with_hole(const std::vector<Vec3>& section, double z0_mm, double z1_mm,
                                    double times = 2.0) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(section.size());
  for (const double share : {1.0, times})
    for (const double z : {z0_mm, z1_mm})
      for (const Vec3& x : section) mesh.points_mm.push_back(Vec3(share * x.x(), share * x.y(), z));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t k = (i + 1) % n;
    add_quad(mesh, i, n + i, n + k, k);
    add_quad(mesh, 2 * n + i, 2 * n + k, 3 * n + k, 3 * n + i);
    add_quad(mesh, i, k, 2 * n + k, 2 * n + i);
    add_quad(mesh, n + i, 3 * n + i, 3 * n + k, n + k);
  }
  return mesh;
}

/// The section at a height.
inline std::vector<Vec3> at_height(std::vector<Vec3> section, double z_mm) {
  for (Vec3& x : section) x.z() = z_mm;
  return section;
}

/// Corners on an ellipse with half axes a and b at equal parameters.
inline std::vector<Vec3> ellipse(double a_mm, double b_mm, int n, double phase_rad = 0.0) {
  std::vector<Vec3> section;
  for (int i = 0; i < n; ++i) {
    const double t = phase_rad + 2.0 * std::numbers::pi * i / n;
    section.emplace_back(a_mm * std::cos(t), b_mm * std::sin(t), 0.0);
  }
  return section;
}

/// A circle of n equal steps, cut off by a flat at x = flat_mm.
inline std::vector<Vec3> d_section(double radius_mm, double flat_mm, int n) {
  const double half = std::acos(flat_mm / radius_mm);
  std::vector<Vec3> section;
  for (int i = 0; i <= n; ++i)
    section.push_back(
        on_circle(radius_mm, half + (2.0 * std::numbers::pi - 2.0 * half) * i / n, 0.0));
  return section;
}

}  // namespace mortise::shapes
