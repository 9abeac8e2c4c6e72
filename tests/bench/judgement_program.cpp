#include "tests/bench/judgement_program.h"

#include <glpk.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "common/base/check.h"

namespace mortise::bench {
namespace {

using Long = long double;
using Matrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
using Column = Eigen::Matrix<Long, Eigen::Dynamic, 1>;

using Problem = std::unique_ptr<glp_prob, void (*)(glp_prob*)>;

Problem problem_of(const OracleProgram& program) {
  Problem problem(glp_create_prob(), glp_delete_prob);
  glp_set_obj_dir(problem.get(), GLP_MAX);
  glp_add_rows(problem.get(), static_cast<int>(program.rows.size()));
  glp_add_cols(problem.get(), program.variables);
  for (int k = 0; k < program.variables; ++k) {
    glp_set_col_bnds(problem.get(), k + 1, GLP_FR, 0.0, 0.0);
    glp_set_obj_coef(problem.get(), k + 1, program.objective[static_cast<std::size_t>(k)]);
  }
  int at = 0;
  for (const OracleProgram::Row& row : program.rows) {
    std::array<int, OracleProgram::kMost + 1> index{};
    std::array<double, OracleProgram::kMost + 1> value{};
    int entries = 0;
    for (int k = 0; k < program.variables; ++k) {
      const double g = row.g[static_cast<std::size_t>(k)];
      if (g == 0.0) continue;
      index[static_cast<std::size_t>(++entries)] = k + 1;
      value[static_cast<std::size_t>(entries)] = g;
    }
    glp_set_mat_row(problem.get(), ++at, entries, index.data(), value.data());
    glp_set_row_bnds(problem.get(), at, GLP_UP, 0.0, row.h);
  }
  return problem;
}

// The vertex in which the active rows of a basis meet. None where they are not independent.
std::optional<OracleProgram::Optimum> vertex_of(const OracleProgram& program, glp_prob* problem) {
  const int n = program.variables;
  Matrix g(n, n);
  Column h(n), objective(n);
  int active = 0;
  for (int i = 0; i < static_cast<int>(program.rows.size()); ++i) {
    if (glp_get_row_stat(problem, i + 1) == GLP_BS) continue;
    if (active == n) return std::nullopt;
    const OracleProgram::Row& row = program.rows[static_cast<std::size_t>(i)];
    for (int k = 0; k < n; ++k) g(active, k) = row.g[static_cast<std::size_t>(k)];
    h(active++) = row.h;
  }
  if (active != n) return std::nullopt;
  for (int k = 0; k < n; ++k) objective(k) = program.objective[static_cast<std::size_t>(k)];
  const Eigen::FullPivLU<Matrix> lu(g);
  if (!lu.isInvertible()) return std::nullopt;
  const Column y = lu.solve(h);
  const Column multipliers = g.transpose().fullPivLu().solve(objective);
  constexpr Long kRounding = 1e-12L;
  if (multipliers.minCoeff() < -kRounding) return std::nullopt;
  OracleProgram::Optimum optimum;
  for (int k = 0; k < n; ++k) optimum.y[static_cast<std::size_t>(k)] = static_cast<double>(y(k));
  for (const OracleProgram::Row& row : program.rows) {
    Long left = row.h;
    for (int k = 0; k < n; ++k) left -= row.g[static_cast<std::size_t>(k)] * y(k);
    if (left < -kRounding) return std::nullopt;
  }
  const Long bound = multipliers.dot(h), reached = objective.dot(y);
  optimum.value = {static_cast<double>(std::min(reached, bound)),
                   static_cast<double>(std::max(reached, bound))};
  return optimum;
}

/// Rows about an origin near the bodies, in lengths of their size: numbers of the order of one.
struct Scaled {
  Scaled(std::span<const HalfSpace> a, std::span<const HalfSpace> b) {
    for (const auto& faces : {a, b})
      for (const HalfSpace& face : faces) length_mm = std::max(length_mm, std::abs(face.c));
  }
  void add(OracleProgram& program, const HalfSpace& face, std::span<const double> more,
           double less_mm = 0.0) const {
    OracleProgram::Row row;
    for (std::size_t k = 0; k < 3; ++k) row.g[k] = face.n[static_cast<Eigen::Index>(k)];
    for (std::size_t k = 0; k < more.size(); ++k) row.g[3 + k] = more[k];
    row.h = (face.c - less_mm) / length_mm;
    program.rows.push_back(row);
  }
  Interval in_mm(const Interval& value) const {
    return {value.lo * length_mm, value.hi * length_mm};
  }
  double length_mm = 1e-6;
};

}  // namespace

std::optional<OracleProgram::Optimum> OracleProgram::solve() const {
  glp_term_out(GLP_OFF);
  const Problem problem = problem_of(*this);
  glp_smcp how;
  glp_init_smcp(&how);
  how.msg_lev = GLP_MSG_OFF;
  how.tol_bnd = how.tol_dj = 1e-11;
  const bool ended = glp_simplex(problem.get(), &how) == 0;
  if (ended && glp_get_status(problem.get()) == GLP_OPT)
    if (auto optimum = vertex_of(*this, problem.get())) return optimum;
  // Rows that are nearly dependent: the same basis improved in rational numbers.
  glp_exact(problem.get(), &how);
  if (glp_get_status(problem.get()) != GLP_OPT) return std::nullopt;
  if (auto optimum = vertex_of(*this, problem.get())) return optimum;
  Optimum optimum;
  for (int k = 0; k < variables; ++k)
    optimum.y[static_cast<std::size_t>(k)] = glp_get_col_prim(problem.get(), k + 1);
  const double value = glp_get_obj_val(problem.get());
  optimum.value = {value, value};
  return optimum;
}

Interval inner_margin_mm(std::span<const HalfSpace> a, std::span<const HalfSpace> b) {
  const Scaled scaled(a, b);
  OracleProgram program{4, {0, 0, 0, 1}, {}};
  for (const auto& faces : {a, b})
    for (const HalfSpace& face : faces) scaled.add(program, face, std::array{1.0});
  const auto optimum = program.solve();
  MORTISE_CHECK(optimum.has_value(), "closed bodies have a largest margin");
  return scaled.in_mm(optimum->value);
}

std::optional<Interval> overlap_depth_mm(std::span<const HalfSpace> a,
                                         std::span<const HalfSpace> b) {
  const Scaled scaled(a, b);
  OracleProgram program{5, {0, 0, 0, 1, 1}, {}};
  for (const HalfSpace& face : a) scaled.add(program, face, std::array{1.0, 0.0});
  for (const HalfSpace& face : b) scaled.add(program, face, std::array{0.0, 1.0});
  program.rows.push_back({{0, 0, 0, -1, 0}, 0.0});
  program.rows.push_back({{0, 0, 0, 0, -1}, 0.0});
  const auto optimum = program.solve();
  if (!optimum) return std::nullopt;
  return scaled.in_mm(optimum->value);
}

double shift_to_margin_mm(std::span<const HalfSpace> a, std::span<const HalfSpace> b,
                          const Vec3& direction, double margin_mm) {
  const Scaled scaled(a, b);
  OracleProgram program{4, {0, 0, 0, 1}, {}};
  for (const HalfSpace& face : a)
    scaled.add(program, face, std::array{-face.n.dot(direction)}, margin_mm);
  for (const HalfSpace& face : b) scaled.add(program, face, std::array{0.0}, margin_mm);
  const auto optimum = program.solve();
  MORTISE_CHECK(optimum.has_value(), "bodies that are thicker than the margin can meet by it");
  return optimum->y[3] * scaled.length_mm;
}

}  // namespace mortise::bench
