#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

struct CleanMesh {
  TriangleMesh mesh;
  std::uint64_t degenerate_dropped = 0;   ///< no area: two corners in one place, or all on a line
  std::uint64_t triangles_split = 0;      ///< neighbours cut in two so that no edge opened
  std::uint64_t duplicate_triangles = 0;  ///< same three points as an earlier one
  std::uint64_t duplicates_dropped = 0;   ///< of them: copies without which the mesh closes
  std::uint64_t corners_moved = 0;        ///< of open edges, onto a corner or edge beside them
  double moved_mm = 0.0;                  ///< the farthest of them
};

/// Loose triangles (nine coordinates each, finite) to triangles over shared points: corners at
/// exactly the same place become one point, triangles without area are dropped and their neighbours
/// split where the surface would open. Points are numbered in the order in which kept triangles use
/// them. Coordinates are multiplied by unit_mm after welding. O(n log n) for any input.
/// near: how far corners of open edges may lie apart, or off another open edge, and still be one
/// (units of the coordinates): twice what the file may have put them off. Nothing else is moved,
/// and nothing where that closes no edge.
CleanMesh weld(const std::vector<double>& coordinates, double unit_mm, double near = 0.0);

}  // namespace mortise
