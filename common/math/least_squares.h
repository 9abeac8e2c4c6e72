#pragma once
#include <Eigen/Core>

namespace mortise {

/// Small dense systems, a few dozen rows; one place for the decompositions, which are slow to
/// compile. Deterministic.

/// The x of least norm that minimises |A x - b|. Singular values below rank_share of the largest
/// are ignored; `rank` receives how many are not (may be null).
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                    double rank_share, int* rank = nullptr);

/// Orthonormal columns that span the vectors x with A x = 0, to rank_share as above.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& A, double rank_share);

}  // namespace mortise
