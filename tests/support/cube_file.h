#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace mortise::test {

/// An STL file of a cube about the origin, edge 2 * half_mm.
inline std::vector<std::byte> cube_file(double half_mm) {
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::string text = "solid cube\n";
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) {
      text += "vertex";
      for (const int bit : {1, 2, 4})
        text += " " + std::to_string((corner & bit) != 0 ? half_mm : -half_mm);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  text += "endsolid cube\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace mortise::test
