#include "common/session/tick/tangent_cone.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/math/least_squares.h"
#include "common/session/guide/relation.h"

namespace mortise {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Gradients below this share of the scale of the problem are rounding.
constexpr double kRounding = 1e-12;

// Lawson and Hanson, NNLS: min |E u - f|, u >= 0. Entering columns by largest gradient, ties by
// index.
Vector non_negative_least_squares(const Matrix& E, const Vector& f) {
  const Eigen::Index n = E.cols();
  Vector u = Vector::Zero(n);
  std::vector<Eigen::Index> passive;
  const auto solve_passive = [&] {
    Matrix P(E.rows(), static_cast<Eigen::Index>(passive.size()));
    for (std::size_t k = 0; k < passive.size(); ++k)
      P.col(static_cast<Eigen::Index>(k)) = E.col(passive[k]);
    return least_norm_solution(P, f, kRounding);
  };
  for (Eigen::Index round = 0; round < 3 * n + 10; ++round) {
    const Vector gradient = E.transpose() * (f - E * u);
    Eigen::Index enter = -1;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (std::find(passive.begin(), passive.end(), j) != passive.end()) continue;
      const double scale = std::max(1e-300, E.col(j).norm());
      if (gradient[j] > kRounding * scale && (enter < 0 || gradient[j] > gradient[enter]))
        enter = j;
    }
    if (enter < 0) break;
    passive.push_back(enter);
    while (!passive.empty()) {
      const Vector z = solve_passive();
      double step = 1.0;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        if (z[i] <= 0.0)
          step = std::min(step, u[passive[k]] / std::max(1e-300, u[passive[k]] - z[i]));
      }
      for (std::size_t k = 0; k < passive.size(); ++k)
        u[passive[k]] += step * (z[static_cast<Eigen::Index>(k)] - u[passive[k]]);
      if (step >= 1.0) break;
      std::vector<Eigen::Index> stay;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        if (z[static_cast<Eigen::Index>(k)] <= 0.0 && u[passive[k]] <= kRounding)
          u[passive[k]] = 0.0;
        else
          stay.push_back(passive[k]);
      }
      if (stay.size() == passive.size()) break;
      passive = std::move(stay);
    }
  }
  return u;
}

// Columns: the motions that may give way, over (shift, lever * turn).
Matrix free_motions(const TangentQuery& query) {
  Matrix free = query.may_turn ? Matrix(Matrix::Identity(6, 6)) : Matrix(Matrix::Identity(6, 3));
  if (query.guides.empty()) return free;
  Matrix rows(static_cast<Eigen::Index>(query.guides.size()), 6);
  for (std::size_t i = 0; i < query.guides.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = query.guides[i].transpose();
  return free * null_space(rows * free, kGuideRankShare);
}

}  // namespace

TangentMove on_tangent_cone(const TangentQuery& query) {
  TangentMove move;
  Vector wanted(6);
  wanted << query.wanted.shift_mm, query.lever_mm * query.wanted.turn_rad;
  const Matrix free = free_motions(query);
  const auto m = static_cast<Eigen::Index>(query.holds.size());
  if (free.cols() == 0) return move;

  // x: what is added to the wanted twist, in the coordinates of the free motions; G x >= h.
  Matrix J(m, 6);
  Vector h(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Hold& hold = query.holds[static_cast<std::size_t>(i)];
    J.row(i).head<3>() = hold.normal_W.transpose();
    J.row(i).tail<3>() =
        ((hold.point_W - query.center_W).cross(hold.normal_W) / query.lever_mm).transpose();
    h[i] = -hold.gap_mm - J.row(i).dot(wanted);
  }
  Vector result = wanted;
  if (m > 0 && h.maxCoeff() > 0.0) {
    const double scale = h.cwiseAbs().maxCoeff();
    Matrix E(free.cols() + 1, m);
    E.topRows(free.cols()) = (J * free).transpose();
    E.bottomRows(1) = h.transpose() / scale;
    Vector f = Vector::Zero(free.cols() + 1);
    f[free.cols()] = 1.0;
    const Vector u = non_negative_least_squares(E, f);
    const Vector r = E * u - f;
    // The residual is 1 or next to 0; half of the digits lie between rounding and a way that is
    // left.
    if (r.norm() < 1e-7) return move;  // no x satisfies all of them
    result += free * (scale / -r[free.cols()] * r.head(free.cols()));
    move.active = static_cast<int>((u.array() > 0.0).count());
  }
  move.possible = true;
  move.twist = {result.head<3>(), result.tail<3>() / query.lever_mm};
  return move;
}

}  // namespace mortise
