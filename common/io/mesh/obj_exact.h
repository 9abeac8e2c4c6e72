#pragma once
#include <filesystem>

#include "common/base/result.h"
#include "common/io/mesh/mesh_clean.h"

namespace mortise {

/// Reads the faces of a Wavefront OBJ file with all digits of its coordinates: import_mesh uses a
/// library that keeps floats (4e-6 mm at 100 mm), too coarse to compare contact times to 1e-6 mm,
/// and finds the digits again only where each float stands for one place.
/// Reads `v` and `f` (any number of corners, v/vt/vn, negative indices); normals, textures, groups,
/// materials and comments are ignored; anything else is an error with file, line and column.
/// Corners are welded by exact position, triangles without area dropped and counted.
Result<CleanMesh> read_obj_exact(const std::filesystem::path& file, double unit_mm);

}  // namespace mortise
