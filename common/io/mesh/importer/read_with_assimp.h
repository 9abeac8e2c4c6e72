#pragma once
#include <filesystem>
#include <string>

#include "common/io/mesh/raw_soup.h"

namespace mortise {

/// Reads a file with assimp's reader for `extension` (lower case, with the dot) and no other: node
/// transforms applied, polygons cut into triangles, points and lines counted and left out. May
/// crash, hang or eat memory on hostile files: only called in a process of its own.
RawSoup read_with_assimp(const std::filesystem::path& file, const std::string& extension);

}  // namespace mortise
