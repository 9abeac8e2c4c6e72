#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// How the two triangles of an edge meet. kNonManifold: more than two triangles, two that run along
/// the edge in the same direction (misoriented), or an edge without length; no side can be told.
enum class EdgeKind : std::uint8_t { kBoundary = 0, kFlat, kConvex, kConcave, kNonManifold };

/// Neighbours and edge classes of a mesh (README, section 1). Edge k of a triangle runs from corner
/// k to corner k+1.
struct Topology {
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::vector<std::array<std::uint32_t, 3>>
      neighbor;  ///< triangle across edge k; kNone at a boundary and where more than two meet
  std::vector<std::array<EdgeKind, 3>> edge_kind;
  std::vector<std::array<bool, 3>> edge_sharp;  ///< exterior angle above kSharpEdge_rad
  std::uint64_t boundary_edges = 0;             ///< edges of one triangle
  std::uint64_t non_manifold_edges = 0;         ///< edges of more than two, or without length
  std::uint64_t misoriented_edges = 0;          ///< edges of two that run in the same direction
  std::uint32_t components = 0;                 ///< pieces connected across edges
  double volume_mm3 = 0.0;

  /// Has an inside: closed, two triangles an edge, consistently oriented, positive volume.
  bool closed() const {
    return boundary_edges == 0 && non_manifold_edges == 0 && misoriented_edges == 0 &&
           volume_mm3 > 0.0;
  }
};

/// Deterministic; O(n) for meshes of bounded valence. Every index of a triangle must name a point.
Topology build_topology(const TriangleMesh& mesh);

/// The slow twin: compares every pair of triangles, O(n^2). For tests.
Topology build_topology_brute_force(const TriangleMesh& mesh);

}  // namespace mortise
