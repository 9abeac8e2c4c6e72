#include "common/math/least_squares.h"

#include <Eigen/SVD>

namespace mortise {

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                    double rank_share, int* rank) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(rank_share);
  if (rank != nullptr) *rank = static_cast<int>(svd.rank());
  return svd.solve(b);
}

Eigen::MatrixXd null_space(const Eigen::MatrixXd& A, double rank_share) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  svd.setThreshold(rank_share);
  return svd.matrixV().rightCols(A.cols() - svd.rank());
}

}  // namespace mortise
