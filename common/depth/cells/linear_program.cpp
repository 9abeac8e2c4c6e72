#include "common/depth/cells/linear_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/base/constants.h"

namespace mortise {
namespace {

// A row is fulfilled within this; it only decides which vertex is taken, never the bound.
constexpr double kFulfilled = 1e-10;
// Beyond this no point fulfils the rows.
constexpr double kInfeasible = 1e-9;
// Rows whose normals are shorter have become parallel to one that is active.
constexpr double kDependent = 1e-11;
// Sums of five products: their rounding, with room.
constexpr double kRoundings = 64.0;

}  // namespace

LinearProgram::LinearProgram(int variables, const Vector& lo, const Vector& hi,
                             const Vector& objective)
    : variables_(variables), lo_(lo), hi_(hi), objective_(objective) {
  MORTISE_CHECK(variables >= 1 && variables <= kMostVariables, "a program has some variables");
  for (int k = 0; k < variables; ++k)
    MORTISE_CHECK(lo[k] <= hi[k] && std::isfinite(hi[k] - lo[k]),
                  "every variable lies between finite bounds, the lower one first");
}

LinearProgram::Level& LinearProgram::set_up() {
  Level& top = level_[variables_];
  top.rows.clear();
  top.lo = lo_;
  top.hi = hi_;
  top.objective = objective_;
  for (int k = 0; k < variables_; ++k) top.variable[k] = k;
  for (std::size_t i = 0; i < rows.size(); ++i)
    top.rows.push_back({rows[i].g, rows[i].h, static_cast<int>(i)});
  return top;
}

bool LinearProgram::maximize(Optimum& optimum) {
  set_up();
  return solve(variables_, optimum);
}

bool LinearProgram::cuts_off(const Row& row, const Optimum& optimum) const {
  double at = -row.h;
  for (int k = 0; k < variables_; ++k) at += row.g[k] * optimum.y[k];
  return at > kFulfilled;
}

bool LinearProgram::maximize_with(const Row& row, Optimum& optimum) {
  rows.push_back(row);
  if (!cuts_off(row, optimum)) return true;
  const Level& top = set_up();
  const Reduced last = top.rows.back();
  return solve_on(variables_, last, top.rows.size() - 1, optimum);
}

bool LinearProgram::solve(int variables, Optimum& found) {
  if (variables == 1) return solve_line(found);
  const Level& level = level_[variables];
  for (int k = 0; k < variables; ++k) {
    const int v = level.variable[k];
    const double slope = level.objective[k];
    found.y[v] = slope > 0.0   ? level.hi[k]
                 : slope < 0.0 ? level.lo[k]
                               : std::clamp(0.0, level.lo[k], level.hi[k]);
    found.active[k] = ~(2 * v + (slope < 0.0 ? 0 : 1));
  }
  for (std::size_t i = 0; i < level.rows.size(); ++i) {
    const Reduced& row = level.rows[i];
    double at = -row.h;
    for (int k = 0; k < variables; ++k) at += row.g[k] * found.y[level.variable[k]];
    if (at > kFulfilled && !solve_on(variables, row, i, found)) return false;
  }
  return true;
}

bool LinearProgram::solve_line(Optimum& found) {
  const Level& level = level_[1];
  const int v = level.variable[0];
  double lo = level.lo[0], hi = level.hi[0];
  int lo_id = ~(2 * v), hi_id = ~(2 * v + 1);
  for (const Reduced& row : level.rows) {
    const double at = row.h / row.g[0];
    if (row.g[0] > 0.0 && at < hi) {
      hi = at;
      hi_id = row.id;
    } else if (row.g[0] < 0.0 && at > lo) {
      lo = at;
      lo_id = row.id;
    }
  }
  if (lo > hi + kInfeasible) return false;
  const double slope = level.objective[0];
  found.y[v] = slope > 0.0 ? hi : slope < 0.0 ? lo : std::clamp(0.0, std::min(lo, hi), hi);
  found.active[0] = slope < 0.0 ? lo_id : hi_id;
  return true;
}

// Rows parallel to the active one bound nothing more, or exclude everything.
bool LinearProgram::push(Level& level, int variables, const Reduced& row) {
  double length = 0.0;
  for (int k = 0; k < variables; ++k) length += row.g[k] * row.g[k];
  length = std::sqrt(length);
  if (length < kDependent) return row.h >= -kInfeasible;
  Reduced scaled = row;
  for (int k = 0; k < variables; ++k) scaled.g[k] /= length;
  scaled.h /= length;
  level.rows.push_back(scaled);
  return true;
}

// The row is fulfilled with equality: one variable is eliminated by it.
bool LinearProgram::solve_on(int variables, const Reduced& row, std::size_t rows_before,
                             Optimum& found) {
  const Level& level = level_[variables];
  Level& below = level_[variables - 1];
  int p = 0;
  for (int k = 1; k < variables; ++k)
    if (std::fabs(row.g[k]) > std::fabs(row.g[p])) p = k;
  if (std::fabs(row.g[p]) < kDependent) return false;
  below.rows.clear();
  const auto reduced = [&](const Vector& g, double h, int id) {
    const double share = g[p] / row.g[p];
    Reduced r;
    for (int k = 0, to = 0; k < variables; ++k)
      if (k != p) r.g[to++] = g[k] - share * row.g[k];
    r.h = h - share * row.h;
    r.id = id;
    return r;
  };
  for (int k = 0, to = 0; k < variables; ++k) {
    if (k == p) continue;
    below.variable[to] = level.variable[k];
    below.lo[to] = level.lo[k];
    below.hi[to] = level.hi[k];
    below.objective[to++] = level.objective[k] - level.objective[p] / row.g[p] * row.g[k];
  }
  const int v = level.variable[p];
  Vector unit{};
  unit[p] = 1.0;
  if (!push(below, variables - 1, reduced(unit, level.hi[p], ~(2 * v + 1)))) return false;
  unit[p] = -1.0;
  if (!push(below, variables - 1, reduced(unit, -level.lo[p], ~(2 * v)))) return false;
  for (std::size_t i = 0; i < rows_before; ++i)
    if (!push(below, variables - 1, reduced(level.rows[i].g, level.rows[i].h, level.rows[i].id)))
      return false;
  Optimum on = found;
  if (!solve(variables - 1, on)) return false;
  double rest = row.h;
  for (int k = 0; k < variables; ++k)
    if (k != p) rest -= row.g[k] * on.y[level.variable[k]];
  on.y[v] = rest / row.g[p];
  on.active[variables - 1] = row.id;
  found = on;
  return true;
}

LinearProgram::Row LinearProgram::row_of(int id) const {
  if (id >= 0) return rows[static_cast<std::size_t>(id)];
  const int k = ~id / 2;
  const bool upper = ~id % 2 == 1;
  Row row;
  row.g[k] = upper ? 1.0 : -1.0;
  row.h = upper ? hi_[k] : -lo_[k];
  return row;
}

// Sum of multiplier times active row = objective, by elimination with pivots.
LinearProgram::Vector LinearProgram::multipliers(const Optimum& optimum) const {
  const int n = variables_;
  double m[kMostVariables][kMostVariables + 1] = {};
  for (int i = 0; i < n; ++i) {
    const Row row = row_of(optimum.active[i]);
    for (int k = 0; k < n; ++k) m[k][i] = row.g[k];
  }
  for (int k = 0; k < n; ++k) m[k][n] = objective_[k];
  for (int i = 0; i < n; ++i) {
    int pivot = i;
    for (int k = i + 1; k < n; ++k)
      if (std::fabs(m[k][i]) > std::fabs(m[pivot][i])) pivot = k;
    if (std::fabs(m[pivot][i]) < kDependent) continue;
    std::swap(m[i], m[pivot]);
    for (int k = 0; k < n; ++k) {
      if (k == i) continue;
      const double share = m[k][i] / m[i][i];
      for (int j = i; j <= n; ++j) m[k][j] -= share * m[i][j];
    }
  }
  Vector weights{};
  for (int i = 0; i < n; ++i)
    if (std::fabs(m[i][i]) >= kDependent) weights[i] = std::max(0.0, m[i][n] / m[i][i]);
  return weights;
}

double LinearProgram::upper_bound(const Optimum& optimum) const {
  const Vector weights = multipliers(optimum);
  Vector left = objective_;
  double bound = 0.0, size = 0.0;
  for (int i = 0; i < variables_; ++i) {
    const Row row = row_of(optimum.active[i]);
    bound += weights[i] * row.h;
    size += std::fabs(weights[i] * row.h);
    for (int k = 0; k < variables_; ++k) left[k] -= weights[i] * row.g[k];
  }
  for (int k = 0; k < variables_; ++k)
    bound += std::fabs(left[k]) * std::max(std::fabs(lo_[k]), std::fabs(hi_[k]));
  return bound + kRoundings * kUnitRoundoff * size;
}

}  // namespace mortise
