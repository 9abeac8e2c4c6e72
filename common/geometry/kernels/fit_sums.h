#pragma once
#include <cstddef>

// One pass of a least squares fit over all points, four at a time. No Eigen type: this header is
// compiled for different instruction sets.
namespace mortise::geometry {

/// A surface about a frame near the points, in units of their extent: a point of it, its axis with
/// two directions across, and its sizes (see surface_fit.cpp).
struct FitModel {
  double p[3], a[3], u[3], v[3];
  double size, other;   ///< cylinder, sphere: radius; cone: radius at p, half angle; torus: both
  double cosine, sine;  ///< of the half angle
};

/// The most that any kind has: those of a torus.
inline constexpr int kMostFitParameters = 7;

/// Cost (sum of squared residuals) and normal equations of the next step.
struct FitPass {
  double cost = 0.0;
  double gradient[kMostFitParameters];
  double normal[kMostFitParameters * (kMostFitParameters + 1) / 2];  ///< lower half, by rows
};

struct FitKernels {
  /// Points in blocks of four: four x, four y, four z; places of the last block beyond `count` are
  /// of no weight. Stops where the cost so far is not below limit: it only grows.
  using Sum = void (*)(const FitModel& model, const double* blocks, std::size_t count, double limit,
                       FitPass& pass);
  Sum cylinder, cone, sphere, torus;
};

/// Baseline instructions, on every machine.
const FitKernels& portable_fit_sums();
/// The same operations in the same order on wider registers; null where they were not compiled or
/// the machine has none.
const FitKernels* wide_fit_sums();
/// What this machine runs best. The answers are the same.
const FitKernels& best_fit_sums();

}  // namespace mortise::geometry
