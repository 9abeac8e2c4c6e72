#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/topology.h"

namespace mortise {

/// The triangle that bounds the same material at an edge.
struct AcrossMaterial {
  std::uint32_t triangle = Topology::kNone;  ///< kNone at a border
  bool convex = false;                       ///< less than half a turn of material is between them
};

/// Across edge k of a triangle its neighbour. At an edge of more than two triangles, as of two
/// bodies that share it, the first one that bounds material on a turn through the material.
AcrossMaterial across_material(const TriangleMesh& mesh, const Topology& topology,
                               std::uint32_t triangle, std::uint32_t k);

/// Triangles around each point by fans, connected through the material: what two bodies of a part
/// have beside each other at a shared point or edge does not meet there.
class Fans {
 public:
  Fans(const TriangleMesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {}

  /// Calls visit(point, triangles) for each fan; triangles in ascending order. O(n).
  template <class Visit>
  void each(Visit&& visit) {
    seen_.assign(3 * mesh_.triangles.size(), false);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k)
        if (!seen_[3 * t + k]) {
          gather(t, mesh_.triangles[t][k]);
          visit(mesh_.triangles[t][k], fan_);
        }
  }

 private:
  void gather(std::uint32_t first, std::uint32_t point);

  const TriangleMesh& mesh_;
  const Topology& topology_;
  std::vector<bool> seen_;  // by 3 * triangle + corner
  std::vector<std::uint32_t> fan_;
};

}  // namespace mortise
