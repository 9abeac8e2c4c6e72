#pragma once
#include <array>
#include <cstdint>
#include <map>
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
  /// Of an edge of more than two triangles: from each of its sides (3 * triangle + edge) to the
  /// next, around all of them.
  std::map<std::uint32_t, std::uint32_t> next_side;
  std::vector<std::array<EdgeKind, 3>> edge_kind;
  std::vector<std::array<bool, 3>> edge_sharp;  ///< exterior angle above kSharpEdge_rad
  std::vector<Vec3> normal;                     ///< outward, unit; zero of a triangle without area
  std::uint64_t boundary_edges = 0;             ///< edges of one triangle
  std::uint64_t non_manifold_edges = 0;         ///< edges of more than two, or without length
  std::uint64_t misoriented_edges = 0;          ///< edges of two that run in the same direction
  /// Edges that triangles pass more often one way than the other: the border of what is open.
  std::uint64_t unbalanced_edges = 0;
  std::uint64_t pinched_points = 0;  ///< points at which more than one fan of triangles meets
  std::uint32_t components = 0;      ///< pieces connected across edges
  double volume_mm3 = 0.0;

  /// Calls visit(triangle) for all others across edge k of a triangle.
  template <class Visit>
  void each_across(std::uint32_t triangle, std::uint32_t k, Visit&& visit) const {
    if (neighbor[triangle][k] != kNone) return visit(neighbor[triangle][k]);
    if (next_side.empty()) return;
    const std::uint32_t mine = 3 * triangle + k;
    const auto first = next_side.find(mine);
    if (first == next_side.end()) return;
    for (std::uint32_t side = first->second; side != mine; side = next_side.at(side))
      visit(side / 3);
  }

  /// Every edge is passed as often one way as the other: the winding number is a whole number
  /// everywhere off the surface (README, section 4).
  bool balanced() const { return unbalanced_edges == 0; }
  /// Has an inside: balanced, positive volume.
  bool closed() const { return balanced() && volume_mm3 > 0.0; }
  /// Closed, two triangles an edge and one fan a point: the normals around a point of the surface
  /// tell on which side of it one is.
  bool manifold() const { return closed() && non_manifold_edges == 0 && pinched_points == 0; }
};

/// Deterministic; O(n) for meshes of bounded valence. Every index of a triangle must name a point.
Topology build_topology(const TriangleMesh& mesh);

/// The slow twin: compares every pair of triangles, O(n^2). For tests.
Topology build_topology_brute_force(const TriangleMesh& mesh);

}  // namespace mortise
