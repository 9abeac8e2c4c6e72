#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// What is wrong with a DAE file, one line; empty: assimp reads it as it is meant. It leaves out
/// what is named and not there, and reads behind an array that is shorter than announced. Linear in
/// the bytes.
std::string wrong_with_dae(std::string_view bytes);

}  // namespace mortise
