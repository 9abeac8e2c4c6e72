#pragma once
#include <cstdint>

#include "common/geometry/mesh.h"

namespace mortise {

/// Takes out faces that two bodies of one file share: pairs of triangles over the same corners that
/// look opposite ways, with material on both sides. Such a pair without material beside it, a sheet
/// of no thickness, stays. Returns the number of triangles taken out. O(n log n).
std::uint64_t take_out_inner_faces(TriangleMesh& mesh);

/// Turns triangles that face against their neighbours: in each piece connected across edges of two
/// triangles the fewer, unless no way to face fits all. Returns the number turned. O(n log n).
std::uint64_t align_neighbours(TriangleMesh& mesh);

/// Shells are pieces of the mesh that balance by themselves (geometry/README.md, section 4).
struct ShellsTurned {
  std::uint32_t shells = 0;
  std::uint32_t turned = 0;
  std::uint32_t filled = 0;  ///< outward, and within one that is: material within material
};

/// Turns shells that face inwards where nothing is there to be hollow: a shell that lies in no
/// other, or in a hollow of another, is outward; what lies wholly within a shell that is turned is
/// turned with it. Pieces that are open stay as they are. O(n log n), and for each shell within the
/// box of another a few rays.
ShellsTurned orient_shells(TriangleMesh& mesh);

}  // namespace mortise
