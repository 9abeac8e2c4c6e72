#include "common/depth/gpd/minimax.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::gpd {
namespace {

// Of reweighting. A twist is valid, and a bound holds, after any of them. These and the two below
// are chosen: half or twice of them moves no bracket of 400 random pairs by a percent.
constexpr int kMostRounds = 40, kMostBoundRounds = 60;
// Rounds without gain after which the program ends, and what counts as one.
constexpr int kIdleRounds = 6;
constexpr double kRoundGain = 2e-5;
// Gap to the lower bound, as a share, at which it has converged.
constexpr double kConverged = 2e-4;
// Keeps the metric positive where all weight is on few corners.
constexpr double kLeastWeight = 1e-9, kRidge = 1e-7, kBoundRidge = 1e-12;
// Rounding of a certified bound, as a share.
constexpr double kBoundRounding = 1e-9;

using Mat6 = Eigen::Matrix<double, 6, 6>;

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

}  // namespace

// M = Σ w JᵀJ = L Lᵀ, J = [1, -[a]], by sums of w, w a and w a aᵀ alone.
struct Minimax::Metric {
  Metric(const std::vector<Vec3>& arms, const std::vector<double>& weights, double ridge) {
    double sum = 0.0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (std::size_t i = 0; i < arms.size(); ++i) {
      sum += weights[i];
      first += weights[i] * arms[i];
      second += weights[i] * arms[i] * arms[i].transpose();
    }
    Mat6 m = ridge * Mat6::Identity();
    const Mat3 k = cross_matrix(first);
    m.topLeftCorner<3, 3>().diagonal().array() += sum;
    m.topRightCorner<3, 3>() -= k;
    m.bottomLeftCorner<3, 3>() += k;
    m.bottomRightCorner<3, 3>() += second.trace() * Mat3::Identity() - second;
    lower = m.llt().matrixL();
  }
  Vec6 map(const Vec6& g) const { return lower.triangularView<Eigen::Lower>().solve(g); }
  Vec6 back(const Vec6& z) const {
    return lower.transpose().triangularView<Eigen::Upper>().solve(z);
  }
  Mat6 lower;
};

// |ξ|² <= excess (longest path)²: by the least eigenvalue of the metric of even weights.
double Minimax::ridge_excess() const {
  const Metric even(
      arms_, std::vector<double>(arms_.size(), 1.0 / static_cast<double>(arms_.size())), 0.0);
  const Mat6 m = even.lower * even.lower.transpose();
  const double least = Eigen::SelfAdjointEigenSolver<Mat6>(m).eigenvalues()[0];
  return least > 0.0 ? 1.0 / least : std::numeric_limits<double>::infinity();
}

Minimax::Minimax(const TwistFrame& frame, const std::vector<Vec3>& corners_W) {
  for (const Vec3& x : corners_W) arms_.push_back((x - frame.center_W) / frame.radius_mm);
  lengths_.resize(arms_.size());
}

bool Minimax::best_translation(const std::vector<Row>& rows, Vec6& xi) const {
  WorkingRows working(rows);
  const auto flat = [](const Vec6& g) {
    Vec6 of_v = g;
    of_v.tail<3>().setZero();
    return of_v;
  };
  return working.solve(flat, flat, xi);
}

// Longest path of the corners; the weights for the next round. `mean_square`: of the paths, by the
// weights so far, whose root no twist can better.
double Minimax::reweigh(const Vec6& xi, double& mean_square) {
  const Vec3 v = xi.head<3>(), w = xi.tail<3>();
  double longest = 0.0, sum = 0.0;
  mean_square = 0.0;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    lengths_[i] = (v + w.cross(arms_[i])).norm();
    longest = std::max(longest, lengths_[i]);
    mean_square += weights_[i] * lengths_[i] * lengths_[i];
  }
  if (!(longest > 0.0)) return 0.0;
  for (std::size_t i = 0; i < arms_.size(); ++i)
    sum += weights_[i] *= lengths_[i] / longest + kLeastWeight;
  for (double& weight : weights_) weight /= sum;
  return longest;
}

bool Minimax::solve(const std::vector<Row>& rows, Vec6& xi) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  ++programs_;
  double best = kNone;
  if (Vec6 shift; best_translation(rows, shift)) {
    xi = shift;
    best = shift.head<3>().norm();
  }
  weights_.assign(arms_.size(), 1.0 / static_cast<double>(arms_.size()));
  WorkingRows working(rows);
  int last_gain = 0;
  for (int round = 0; round < kMostRounds && round - last_gain <= kIdleRounds; ++round) {
    const Metric metric(arms_, weights_, kRidge);
    Vec6 now;
    if (!working.solve([&](const Vec6& g) { return metric.map(g); },
                       [&](const Vec6& z) { return metric.back(z); }, now))
      break;
    double mean_square = 0.0;
    const double longest = reweigh(now, mean_square);
    if (longest < best * (1.0 - kRoundGain)) last_gain = round;
    if (longest < best) {
      best = longest;
      xi = now;
    }
    if (longest == 0.0 || best - std::sqrt(mean_square) < kConverged * best) break;
  }
  return best < kNone;
}

double Minimax::lower_bound_mm(const std::vector<Row>& rows, double enough_mm) {
  ++programs_;
  weights_.assign(arms_.size(), 1.0 / static_cast<double>(arms_.size()));
  std::vector<Row> mapped(rows.size());
  const double ridge = 1.0 + kBoundRidge * ridge_excess();
  double best = 0.0;
  for (int round = 0; round < kMostBoundRounds; ++round) {
    const Metric metric(arms_, weights_, kBoundRidge);
    for (std::size_t i = 0; i < rows.size(); ++i) mapped[i] = {metric.map(rows[i].g), rows[i].h};
    const LeastDistance least = least_distance(mapped);
    // |z|² = ξᵀ M ξ <= (longest path)² + kBoundRidge |ξ|², as the weights sum to one.
    best = std::max(best, least.bound / std::sqrt(ridge) * (1.0 - kBoundRounding));
    if (best > enough_mm || !least.solved) break;
    double mean_square = 0.0;
    if (reweigh(metric.back(least.z), mean_square) <= enough_mm) break;
  }
  return best;
}

}  // namespace mortise::gpd
