#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

struct CleanMesh {
  TriangleMesh mesh;
  std::uint64_t degenerate_dropped = 0;   ///< no area: two corners in one place, or all on a line
  std::uint64_t triangles_split = 0;      ///< neighbours cut in two so that no edge opened
  std::uint64_t duplicate_triangles = 0;  ///< same three points as an earlier one; kept
};

/// Loose triangles (nine coordinates each, finite) to triangles over shared points: corners at
/// exactly the same place become one point, triangles without area are dropped and their neighbours
/// split where the surface would open. Points are numbered in the order in which kept triangles use
/// them. Coordinates are multiplied by unit_mm after welding. O(n log n) for any input.
CleanMesh weld(const std::vector<double>& coordinates, double unit_mm);

}  // namespace mortise
