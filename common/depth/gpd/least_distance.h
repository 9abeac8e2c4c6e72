#pragma once
#include <vector>

#include "common/depth/gpd/twist.h"

namespace mortise::gpd {

/// g · z >= h.
struct Row {
  Vec6 g = Vec6::Zero();
  double h = 0.0;
};

struct LeastDistance {
  bool solved = false;    ///< false: no z satisfies the rows, or rounding did not let it be found
  Vec6 z = Vec6::Zero();  ///< the shortest z that does
  double bound = 0.0;     ///< no z that satisfies the rows is shorter, whether solved or not
};

/// The shortest z with g · z >= h for all rows: least distance programming by non-negative least
/// squares (Lawson and Hanson 1974, chapter 23), seven equations, no allocation. `bound` is
/// certified by the multipliers y >= 0, whatever they are: h·y <= (Σ y g)·z <= |Σ y g| |z|.
LeastDistance least_distance(const std::vector<Row>& rows);

/// The rows of a program that matter are few: rows join as they turn out to be broken. Keeps them
/// between programs with the same rows.
class WorkingRows {
 public:
  explicit WorkingRows(const std::vector<Row>& rows);
  /// `map` is applied to each g: the metric in which z is short (z = L ξ; g' = L⁻ᵀ... given by the
  /// caller), `back` brings z to ξ.
  template <class Map, class Back>
  bool solve(const Map& map, const Back& back, Vec6& xi) {
    for (int more = 0; more < kMostJoins; ++more) {
      mapped_.clear();
      for (const std::size_t i : use_) mapped_.push_back({map(rows_[i].g), rows_[i].h});
      const LeastDistance least = least_distance(mapped_);
      if (!least.solved) return false;
      xi = back(least.z);
      if (!join_broken(xi)) return true;
    }
    return false;
  }

 private:
  // Each round adds up to four rows of which six matter. The searches of 400 random pairs
  // (gpd_pairs of tests/bench) took at most 5 rounds; eight times that ends a program that rounding
  // turns round.
  static constexpr int kMostJoins = 40;
  bool join_broken(const Vec6& xi);

  const std::vector<Row>& rows_;
  double scale_ = 0.0;
  std::vector<std::size_t> use_;
  std::vector<char> used_;
  std::vector<Row> mapped_;
};

}  // namespace mortise::gpd
