#include "common/geometry/across_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise {
namespace {

// Sides of an edge at the same angle fold onto each other: a whole turn, not none.
constexpr double kLeastAngle_rad = 1e-9;

// From the edge into the triangle, for edge k as the triangle passes it.
Vec3 into(const TriangleMesh& mesh, const Topology& topology, std::uint32_t t, std::uint32_t k) {
  const Vec3 along =
      mesh.corner(t, static_cast<int>((k + 1) % 3)) - mesh.corner(t, static_cast<int>(k));
  return topology.normal[t].cross(along);
}

}  // namespace

AcrossMaterial across_material(const TriangleMesh& mesh, const Topology& topology,
                               std::uint32_t triangle, std::uint32_t k) {
  if (const std::uint32_t other = topology.neighbor[triangle][k]; other != Topology::kNone)
    return {other, topology.edge_kind[triangle][k] == EdgeKind::kConvex};
  AcrossMaterial found;
  const std::uint32_t from = mesh.triangles[triangle][k];
  const Vec3 inwards = into(mesh, topology, triangle, k);
  const Vec3 side = -inwards.norm() * topology.normal[triangle];  // where the material is
  double least_rad = 0.0;
  const std::uint32_t mine = 3 * triangle + k;
  const auto first = topology.next_side.find(mine);
  if (first == topology.next_side.end()) return found;
  for (std::uint32_t at = first->second; at != mine; at = topology.next_side.at(at)) {
    if (mesh.triangles[at / 3][at % 3] == from) continue;  // passes the edge the same way
    const Vec3 to = into(mesh, topology, at / 3, at % 3);
    double angle_rad = std::atan2(side.dot(to), inwards.dot(to));
    if (angle_rad < kLeastAngle_rad) angle_rad += 2.0 * std::numbers::pi;
    if (found.triangle != Topology::kNone && angle_rad >= least_rad) continue;
    least_rad = angle_rad;
    found = {at / 3, angle_rad < std::numbers::pi};
  }
  return found;
}

void Fans::gather(std::uint32_t first, std::uint32_t point) {
  fan_.clear();
  const auto corner_of = [&](std::uint32_t t) {
    const auto& points = mesh_.triangles[t];
    return static_cast<std::uint32_t>(std::find(points.begin(), points.end(), point) -
                                      points.begin());
  };
  const auto take = [&](std::uint32_t t) {
    const std::uint32_t k = corner_of(t);
    if (k == 3 || seen_[3 * t + k]) return;
    seen_[3 * t + k] = true;
    fan_.push_back(t);
  };
  take(first);
  for (std::size_t i = 0; i < fan_.size(); ++i) {
    const std::uint32_t t = fan_[i], k = corner_of(t);
    for (const std::uint32_t edge : {k, (k + 2) % 3})  // both have the point as an end
      if (const AcrossMaterial across = across_material(mesh_, topology_, t, edge);
          across.triangle != Topology::kNone)
        take(across.triangle);
  }
  std::sort(fan_.begin(), fan_.end());
}

}  // namespace mortise
