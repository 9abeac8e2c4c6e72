#include "tests/bench/grid_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace mortise::bench {
namespace {

class GridPhase final : public BroadPhase {
 public:
  explicit GridPhase(double cell_mm) : cell_mm_(cell_mm) {}

  void set_box(std::uint32_t part, const Box& box) override {
    if (part >= boxes_.size()) boxes_.resize(part + 1);
    const Cells from = cells_of(boxes_[part]), to = cells_of(box);
    boxes_[part] = box;
    if (from == to) return;
    each(from, [&](std::uint64_t cell) { std::erase(cells_[cell], part); });
    each(to, [&](std::uint64_t cell) { cells_[cell].push_back(part); });
  }

  void find_pairs(std::span<const std::uint32_t> moved, std::vector<IndexPair>& pairs) override {
    pairs.clear();
    for (const std::uint32_t part : moved)
      each(cells_of(boxes_[part]), [&](std::uint64_t cell) {
        for (const std::uint32_t other : cells_[cell])
          if (other != part && boxes_[part].overlaps(boxes_[other]))
            pairs.push_back({std::min(part, other), std::max(part, other)});
      });
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }

 private:
  using Cells = std::array<std::int64_t, 6>;  // from and to, by axis; an empty box has none
  Cells cells_of(const Box& box) const {
    Cells cells{0, 0, 0, -1, -1, -1};
    if (!(box.lo.array() <= box.hi.array()).all()) return cells;
    for (int k = 0; k < 3; ++k) {
      cells[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>(std::floor(box.lo[k] / cell_mm_));
      cells[static_cast<std::size_t>(k) + 3] =
          static_cast<std::int64_t>(std::floor(box.hi[k] / cell_mm_));
    }
    return cells;
  }
  template <class Visit>
  static void each(const Cells& c, const Visit& visit) {
    for (std::int64_t i = c[0]; i <= c[3]; ++i)
      for (std::int64_t j = c[1]; j <= c[4]; ++j)
        for (std::int64_t k = c[2]; k <= c[5]; ++k)
          visit((static_cast<std::uint64_t>(i) & 0x1fffff) << 42 |
                (static_cast<std::uint64_t>(j) & 0x1fffff) << 21 |
                (static_cast<std::uint64_t>(k) & 0x1fffff));
  }

  const double cell_mm_;
  std::vector<Box> boxes_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_grid_phase(double cell_mm) {
  return std::make_unique<GridPhase>(cell_mm);
}

}  // namespace mortise::bench
