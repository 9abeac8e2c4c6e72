#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// What is wrong with the header of a PLY file, one line; empty: it is a header, and the file has
/// room for all that it announces. assimp counts to whatever a header says. Linear in the bytes of
/// the header.
std::string wrong_with_ply(std::string_view bytes);

}  // namespace mortise
