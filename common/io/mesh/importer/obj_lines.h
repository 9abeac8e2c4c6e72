#pragma once
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace mortise {

/// The vertices, faces, lines and points of an OBJ file, one plain line each: three coordinates as
/// they are written, corners by their vertices alone. All else that may stand in an OBJ holds no
/// triangles and is left out: assimp ends a comment elsewhere, passes over lines that are indented
/// or that it does not know, and takes numbers from the next line where one has too few. Refused
/// with the first bad line: statements that are none of OBJ, vertices without three finite numbers,
/// faces without three corners. Linear in the bytes.
Result<std::string> strict_obj(std::string_view bytes);

}  // namespace mortise
