#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise::test {

/// A binary STL file of a mesh.
inline std::vector<std::byte> stl_file(const TriangleMesh& mesh) {
  std::vector<std::byte> file(80);  // the header says nothing
  const auto append = [&file](const auto& value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    file.insert(file.end(), bytes, bytes + sizeof value);
  };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    append(std::array<float, 3>{});  // no normal: readers work it out
    for (const std::uint32_t corner : triangle)
      for (int axis = 0; axis < 3; ++axis) append(static_cast<float>(mesh.points_mm[corner][axis]));
    append(std::uint16_t{0});
  }
  return file;
}

}  // namespace mortise::test
