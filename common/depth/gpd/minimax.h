#pragma once
#include <cstdint>
#include <vector>

#include "common/depth/gpd/least_distance.h"

namespace mortise::gpd {

/// Twists by the longest path of some corners of a part: the least of max_p |v + w x (p - c)| under
/// linear rows. A second-order cone per corner; solved by Lawson's reweighting (Lawson 1961), each
/// step a least distance program in the metric Σ w_p J_pᵀ J_p.
class Minimax {
 public:
  Minimax(const TwistFrame& frame, const std::vector<Vec3>& corners_W);

  /// The least to about 2e-4 of it. Translations alone are tried first. False: rows that no twist
  /// satisfies, or none was found.
  bool solve(const std::vector<Row>& rows, Vec6& xi);

  /// A certified lower bound of that least. Stops when it is above `enough`, or a twist no longer
  /// than that satisfies the rows.
  double lower_bound_mm(const std::vector<Row>& rows, double enough_mm);

  std::uint64_t programs() const { return programs_; }

 private:
  struct Metric;
  double ridge_excess() const;
  bool best_translation(const std::vector<Row>& rows, Vec6& xi) const;
  double reweigh(const Vec6& xi, double& mean_square);

  std::vector<Vec3> arms_;  // (p - c) / R
  std::vector<double> weights_, lengths_;
  std::uint64_t programs_ = 0;
};

}  // namespace mortise::gpd
