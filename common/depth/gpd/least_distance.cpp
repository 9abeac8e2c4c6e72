#include "common/depth/gpd/least_distance.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace mortise::gpd {
namespace {

// Six unknowns and a multiplier: no basis has more rows.
constexpr int kSeven = 7;
// A row enters in each step, seven stay at most. The bound holds for the multipliers of any step.
constexpr int kMostSteps = 60;
// Each drop takes a row away: there are no more than seven.
constexpr int kMostDrops = 20;
// A row whose multiplier would gain less is left out.
constexpr double kLeastGain = 1e-11;
// A multiplier that is zero but for rounding.
constexpr double kLeastMultiplier = 1e-14;
// Remainder below which the rows contradict each other.
constexpr double kContradiction = 1e-9;
// Broken rows that join at once, and by how much a row must be broken.
constexpr int kJoinAtOnce = 4;
constexpr double kBrokenShare = 1e-7, kBroken_mm = 1e-9;

using Vec7 = Eigen::Matrix<double, kSeven, 1>;
using Columns = Eigen::Matrix<double, kSeven, Eigen::Dynamic, Eigen::ColMajor, kSeven, kSeven>;
using Multipliers = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kSeven, 1>;

// Non-negative least squares: E y = f, f the last unit vector; columns of E are (g, h / scale).
class NonNegative {
 public:
  NonNegative(const std::vector<Row>& rows, double scale) : rows_(rows), scale_(scale) {}

  void run() {
    for (int step = 0; step < kMostSteps && count_ < kSeven; ++step)
      if (!enter()) break;
  }
  const Vec7& remainder() const { return remainder_; }
  template <class Visit>
  void each(Visit&& visit) const {
    for (int k = 0; k < count_; ++k) visit(rows_[index_[k]], y_[k]);
  }

 private:
  Vec7 column(std::size_t i) const {
    Vec7 e;
    e << rows_[i].g, rows_[i].h / scale_;
    return e;
  }

  bool enter() {
    std::size_t best = rows_.size();
    double gain = kLeastGain;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (std::find(index_, index_ + count_, i) != index_ + count_) continue;
      const double now = column(i).dot(remainder_);
      if (now > gain) {
        gain = now;
        best = i;
      }
    }
    if (best == rows_.size()) return false;
    index_[count_] = best;
    y_[count_++] = 0.0;
    for (int drop = 0; drop < kMostDrops && count_ > 0; ++drop)
      if (toward_least_squares()) break;
    remainder_ = Vec7::Unit(kSeven - 1);
    bool stays = false;
    for (int k = 0; k < count_; ++k) {
      remainder_ -= y_[k] * column(index_[k]);
      stays = stays || index_[k] == best;
    }
    return stays;  // else it entered only to be dropped: rounding
  }

  // True: all multipliers of the least squares solution are positive.
  bool toward_least_squares() {
    Columns e(kSeven, count_);
    for (int k = 0; k < count_; ++k) e.col(k) = column(index_[k]);
    const Multipliers s = e.colPivHouseholderQr().solve(Vec7(Vec7::Unit(kSeven - 1)));
    double share = 1.0;
    for (int k = 0; k < count_; ++k)
      if (s[k] <= 0.0) share = std::min(share, y_[k] / std::max(1e-300, y_[k] - s[k]));
    int kept = 0;
    const bool all = share >= 1.0;
    for (int k = 0; k < count_; ++k) {
      const double y = y_[k] + share * (s[k] - y_[k]);
      if (!all && !(y > kLeastMultiplier)) continue;
      index_[kept] = index_[k];
      y_[kept++] = y;
    }
    count_ = kept;
    return all;
  }

  const std::vector<Row>& rows_;
  const double scale_;
  int count_ = 0;
  std::size_t index_[kSeven] = {};
  double y_[kSeven] = {};
  Vec7 remainder_ = Vec7::Unit(kSeven - 1);
};

}  // namespace

LeastDistance least_distance(const std::vector<Row>& rows) {
  LeastDistance least;
  least.solved = true;
  double scale = 0.0;
  for (const Row& row : rows) scale = std::max(scale, std::fabs(row.h));
  if (std::none_of(rows.begin(), rows.end(), [](const Row& row) { return row.h > 0.0; }))
    return least;
  NonNegative program(rows, scale);
  program.run();
  Vec6 sum = Vec6::Zero();
  double up = 0.0, rounding = 0.0;
  program.each([&](const Row& row, double y) {
    sum += y * row.g;
    up += y * row.h;
    rounding += 1e-12 * y * (row.g.norm() + std::fabs(row.h));
  });
  if (up > rounding) least.bound = (up - rounding) / (sum.norm() + rounding);
  const Vec7& r = program.remainder();
  if (r[kSeven - 1] < kContradiction) {
    least.solved = false;
    return least;
  }
  least.z = -r.head<6>() / r[kSeven - 1] * scale;
  MORTISE_CHECK(least.z.allFinite() && least.bound >= 0.0, "a least distance is a length");
  for (const Row& row : rows)
    if (row.g.dot(least.z) < row.h - 1e-6 * scale - 1e-12) least.solved = false;
  return least;
}

WorkingRows::WorkingRows(const std::vector<Row>& rows) : rows_(rows), used_(rows.size(), 0) {
  for (const Row& row : rows) scale_ = std::max(scale_, std::fabs(row.h));
}

bool WorkingRows::join_broken(const Vec6& xi) {
  std::size_t worst[kJoinAtOnce];
  double lack[kJoinAtOnce];
  int count = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double by = rows_[i].h - rows_[i].g.dot(xi);
    if (used_[i] != 0 || !(by > kBrokenShare * scale_ + kBroken_mm)) continue;
    int at = std::min(count, kJoinAtOnce - 1);
    if (count == kJoinAtOnce && by <= lack[at]) continue;
    for (; at > 0 && lack[at - 1] < by; --at) {
      lack[at] = lack[at - 1];
      worst[at] = worst[at - 1];
    }
    lack[at] = by;
    worst[at] = i;
    count = std::min(count + 1, kJoinAtOnce);
  }
  for (int k = 0; k < count; ++k) {
    use_.push_back(worst[k]);
    used_[worst[k]] = 1;
  }
  return count > 0;
}

}  // namespace mortise::gpd
