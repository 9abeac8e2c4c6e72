#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/math/interval.h"
#include "common/math/types.h"

/// Linear programs of the oracles, by GLPK: nothing here is shared with the engine.
namespace mortise::bench {

/// Maximize objective · y over all y with g · y <= h for each row. The first `variables` entries
/// count; y is free but for the rows.
struct OracleProgram {
  static constexpr int kMost = 5;
  using Vector = std::array<double, kMost>;
  struct Row {
    Vector g{};
    double h = 0.0;
  };
  struct Optimum {
    Vector y{};
    Interval value;  ///< reached at y up to rounding; no more than hi, by the dual multipliers
  };

  int variables = 0;
  Vector objective{};
  std::vector<Row> rows;

  /// The vertex that GLPK finds, computed anew from its active rows. Numbers should be of the order
  /// of one. None: infeasible or unbounded.
  std::optional<Optimum> solve() const;
};

/// {x : n · x <= c}: a face of one of two convex bodies.
struct HalfSpace {
  Vec3 n;
  double c = 0.0;
};

/// Largest s such that some x lies at least s inside all half-spaces: > 0 exactly if the interiors
/// of both bodies meet. mm.
Interval inner_margin_mm(std::span<const HalfSpace> a, std::span<const HalfSpace> b);

/// Largest sum of the depths of a point in both bodies: the overlap delta. None: they do not meet.
/// mm.
std::optional<Interval> overlap_depth_mm(std::span<const HalfSpace> a,
                                         std::span<const HalfSpace> b);

/// How far A must be moved along `direction` so that the inner margin is margin_mm and moving on
/// makes it less. mm.
double shift_to_margin_mm(std::span<const HalfSpace> a, std::span<const HalfSpace> b,
                          const Vec3& direction, double margin_mm);

}  // namespace mortise::bench
