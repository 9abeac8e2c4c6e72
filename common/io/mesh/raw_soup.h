#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace mortise {

/// The result of the importer process for a file: a refusal, or loose triangles. File units.
struct RawSoup {
  std::string refusal;          ///< not empty: nothing else is set
  std::string format;           ///< "STL", "OBJ", ...
  std::string note;             ///< what the reader left out or found strange; often empty
  double stated_unit_mm = 0.0;  ///< mm per unit that the file itself states (DAE); 0: none
  double quantum = 0.0;  ///< largest rounding of a coordinate on its way from the file, file units
  std::uint64_t raw_vertices = 0;
  std::uint64_t points_and_lines = 0;  ///< faces of one or two corners, left out
  std::vector<double> coordinates;     ///< nine a triangle
};

/// Most triangles that one file may hold: 1.4 GB of coordinates. Far above any part (the largest
/// measured has 263,730); a hostile file can place one mesh a million times.
inline constexpr std::uint64_t kMostRawTriangles = 20'000'000;

/// The bytes that the importer process sends to ours. Same machine, same byte order.
std::vector<std::byte> encode(const RawSoup& soup);

/// The file may have taken over the sender, so every length is checked against the bytes that are
/// there, and every coordinate must be finite.
Result<RawSoup> decode(std::span<const std::byte> bytes);

}  // namespace mortise
