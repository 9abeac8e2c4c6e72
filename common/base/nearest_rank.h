#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mortise {

/// Where the q-quantile of n values stands when they are sorted: rank ceil(q n), counted from 0.
/// n > 0, q in [0, 1]. The value there is one of the values; of few values p99 is the largest.
inline std::size_t nearest_rank(std::size_t n, double q) {
  // 0.07 * 100 is a little above 7; a product of a whole number and a share is no finer than this.
  const double rank = std::ceil(q * static_cast<double>(n) * (1.0 - 1e-12));
  return std::clamp(static_cast<std::size_t>(std::max(rank, 1.0)), std::size_t{1}, n) - 1;
}

/// Value at that rank; 0 without values.
inline double quantile_of_sorted(const std::vector<double>& sorted, double q) {
  return sorted.empty() ? 0.0 : sorted[nearest_rank(sorted.size(), q)];
}

}  // namespace mortise
