#include "common/io/mesh_clean.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mortise {
namespace {

/// A triangle lower than this part of its longest edge has no area: no drawing has a sliver of one
/// to a billion, and no normal could be taken from it.
constexpr double kNoHeight = 1e-9;

using Corners = std::array<std::uint32_t, 3>;

/// For each corner the first corner at exactly the same place.
std::vector<std::uint32_t> first_at_same_place(const std::vector<Vec3>& corners) {
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](std::uint32_t i, std::uint32_t j) {
    const Vec3& a = corners[i];
    const Vec3& b = corners[j];
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    if (a.z() != b.z()) return a.z() < b.z();
    return i < j;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> first(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && corners[order[i]] == corners[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

bool without_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest2 =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= kNoHeight * longest2;
}

std::uint64_t count_duplicates(const std::vector<Corners>& triangles) {
  std::vector<Corners> sorted = triangles;
  for (Corners& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] == sorted[i - 1] ? 1 : 0;
  return count;
}

}  // namespace

CleanMesh weld(const std::vector<double>& coordinates, double unit_mm) {
  // 1. Corners; adding zero turns -0 into 0, so that both weld and hash alike.
  std::vector<Vec3> corners(coordinates.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] =
        Vec3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]).array() + 0.0;
  const std::vector<std::uint32_t> first = first_at_same_place(corners);

  // 2. Triangles that have an area, points in the order of their use.
  CleanMesh clean;
  constexpr std::uint32_t kNotUsed = 0xffffffffU;
  std::vector<std::uint32_t> number(corners.size(), kNotUsed);
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) {
    if (without_area(corners[i], corners[i + 1], corners[i + 2])) {
      ++clean.degenerate_dropped;
      continue;
    }
    Corners triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t& point = number[first[i + k]];
      if (point == kNotUsed) {
        point = static_cast<std::uint32_t>(clean.mesh.points_mm.size());
        clean.mesh.points_mm.push_back(unit_mm * corners[i + k]);
      }
      triangle[k] = point;
    }
    clean.mesh.triangles.push_back(triangle);
  }
  clean.duplicate_triangles = count_duplicates(clean.mesh.triangles);
  return clean;
}

}  // namespace mortise
