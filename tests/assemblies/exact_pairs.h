#pragma once
#include <string>

namespace mortise::test {

/// Prints what OpenCASCADE alone says of an assembly, as lines of text that share no code with the
/// importer: each solid instance ("part NUMBER x y z volume", centre of mass in mm), then all pairs
/// whose boxes meet ("pair A B volume thickness seconds", volume -1 where the Boolean failed).
bool print_exact_pairs(const std::string& file);

/// Writes a file again as another program would: the tree in the opposite order, the faces of all
/// parts numbered anew.
bool rewrite(const std::string& from, const std::string& to);

}  // namespace mortise::test
