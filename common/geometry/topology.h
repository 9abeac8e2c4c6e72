#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

enum class EdgeKind : std::uint8_t { kBoundary = 0, kFlat, kConvex, kConcave, kNonManifold };

/// Neighbours and edge classes of a mesh (ALG 3.6). Edge k of a triangle runs from corner k to
/// corner k+1.
struct Topology {
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::vector<std::array<std::uint32_t, 3>>
      neighbor;  ///< triangle across edge k; kNone at a boundary
  std::vector<std::array<EdgeKind, 3>> edge_kind;
  std::vector<std::array<bool, 3>> edge_sharp;  ///< exterior angle above kSharpEdge_rad
  std::uint64_t boundary_edges = 0, non_manifold_edges = 0, misoriented_edges = 0;
  std::uint32_t components = 0;
  double volume_mm3 = 0.0;

  /// Has an inside: closed, two triangles an edge, consistently oriented, positive volume.
  bool closed() const {
    return boundary_edges == 0 && non_manifold_edges == 0 && misoriented_edges == 0 &&
           volume_mm3 > 0.0;
  }
};

Topology build_topology(const TriangleMesh& mesh);

}  // namespace mortise
