#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace mortise {

/// An edge that triangles pass more often from `from` to `to` than back: `times` more.
struct BorderEdge {
  std::uint32_t from = 0, to = 0;
  std::int32_t times = 0;
  std::uint32_t triangle = 0;  ///< one that passes it that way
};

/// All of them, ascending by the lower and then the higher point. Empty: every edge balances
/// (README, section 4). Triangles may have equal corners. O(n log n).
std::vector<BorderEdge> border_of(const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace mortise
