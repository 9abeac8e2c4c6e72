#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// What is wrong with the first bad line of an OBJ file, one line; empty: all of them are
/// statements of OBJ, its vertices have finite numbers, as many as there may be, and its faces
/// corners. assimp passes over what it does not know, and takes numbers from the next line where
/// one has too few. Linear in the bytes.
std::string wrong_with_obj(std::string_view bytes);

}  // namespace mortise
