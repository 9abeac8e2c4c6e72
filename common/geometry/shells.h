#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// The lowest triangle of every connected shell of the mesh, ascending. Triangles are connected by
/// corners at bitwise equal places, so that an unwelded mesh has no more shells than a welded one.
/// O(n log n).
std::vector<std::uint32_t> first_triangle_of_each_shell(const TriangleMesh& mesh);

}  // namespace mortise
