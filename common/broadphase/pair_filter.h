#pragma once
#include <cstdint>

namespace mortise {

/// What the filter knows of one part of a pair in this tick.
struct FilterPart {
  bool can_move = false;  ///< declared moving; false: static
  bool moved = false;     ///< moves in this tick, or was placed since the last one
};

/// Why a pair need not be asked, first reason that applies.
enum class PairSkip : std::uint8_t { kAsk = 0, kStatic, kStill, kExcluded };

/// Two static parts need no new answer, two still parts keep their last one, and the scenario
/// accepts excluded pairs.
constexpr PairSkip filter_pair(FilterPart a, FilterPart b, bool excluded) {
  if (!a.can_move && !b.can_move) return PairSkip::kStatic;
  if (!a.moved && !b.moved) return PairSkip::kStill;
  return excluded ? PairSkip::kExcluded : PairSkip::kAsk;
}

/// How many pairs of a whole scene the filter skips, by counting alone.
struct PairCensus {
  std::uint64_t all = 0, both_static = 0, both_still = 0;
};

/// n parts, of which `can_move` are declared moving and `moved` of those move in this tick.
constexpr PairCensus count_pairs(std::uint64_t n, std::uint64_t can_move, std::uint64_t moved) {
  const auto choose2 = [](std::uint64_t k) { return k < 2 ? 0 : k * (k - 1) / 2; };
  const std::uint64_t both_static = choose2(n - can_move);
  return {choose2(n), both_static, choose2(n - moved) - both_static};
}

}  // namespace mortise
