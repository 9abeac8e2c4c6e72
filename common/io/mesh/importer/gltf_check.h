#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "common/io/mesh/importer/folder_files.h"

namespace mortise {

/// What is wrong with a glTF file, one line; empty: assimp reads it as it is meant. It drops faces
/// whose corners are not there, takes what is no number of its kind for nothing, rotates by any
/// four numbers, and passes over required extensions. `binary`: a GLB. Opens, through `files`, the
/// files of the indices.
std::string wrong_with_gltf(std::string_view bytes, bool binary,
                            const std::filesystem::path& folder, FolderFiles& files);

}  // namespace mortise
