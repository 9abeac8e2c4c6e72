#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace mortise {

/// Disjoint sets of the numbers from 0 on. The least number of a set leads it: what is numbered by
/// leaders does not depend on the order in which sets were joined.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count = 0) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(parent_.size()); }
  /// One more number, in a set of its own.
  void add() { parent_.push_back(size()); }

  std::uint32_t leader_of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool leads(std::uint32_t i) const { return parent_[i] == i; }
  std::uint32_t count_sets() const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size(); ++i) count += leads(i) ? 1 : 0;
    return count;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = leader_of(a);
    b = leader_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace mortise
