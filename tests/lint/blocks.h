#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace mortise::lint {

/// A class or a function of a C++ source.
struct Block {
  enum class Kind { kClass, kFunction };
  Kind kind = Kind::kFunction;
  std::string name;  ///< with the classes around it: Client::release; a test: TEST(Suite, Case)
  std::string member_of;  ///< the class, if it is a member function that stands outside of it
  std::size_t line = 0;   ///< where it begins, from 1
  std::size_t lines = 0;  ///< from there to its closing brace
};

/// The classes and functions of a source in the order in which they end. What stands inside of a
/// function belongs to the function. Knows C++ as clang-format lays it out, not all of C++.
std::vector<Block> blocks_of(const std::string& source);

}  // namespace mortise::lint
