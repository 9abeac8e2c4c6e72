#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/box.h"

namespace mortise {

/// Two parts by index, a < b.
struct IndexPair {
  std::uint32_t a = 0, b = 0;
  friend constexpr auto operator<=>(const IndexPair&, const IndexPair&) = default;
};

/// Which parts could meet: boxes in, candidate pairs out. The boxes are kept between ticks, so that
/// a tick costs only the parts that it names. The answer depends on the boxes alone: closed boxes
/// that share a point are candidates in every implementation.
class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  /// World box of part `part`, mm, finite; the first call for a part adds it. Parts are numbered
  /// from 0. A part whose box is empty has no candidates.
  virtual void set_box(std::uint32_t part, const Box& box) = 0;
  /// All pairs of overlapping boxes of which at least one part is in `moved` (no repeats in it, all
  /// of them added).
  /// Sorted, each pair once. `pairs` is replaced, its capacity reused.
  virtual void find_pairs(std::span<const std::uint32_t> moved, std::vector<IndexPair>& pairs) = 0;
};

}  // namespace mortise
