#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace mortise {

/// Levels of what a mesh file holds in each other: readers go down them by calls of themselves,
/// and no program writes a file that is near it.
inline constexpr std::size_t kMostLevels = 1000;

/// What is wrong with things of which each holds others, by number, and that are called so; empty:
/// nothing. Linear in the links.
std::string wrong_with_nesting(const std::vector<std::vector<std::size_t>>& holds,
                               const std::string& called);

std::string too_deep(const std::string& called);

}  // namespace mortise
