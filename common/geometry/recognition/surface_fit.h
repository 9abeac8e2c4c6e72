#pragma once
#include <optional>
#include <span>

#include "common/geometry/feature.h"

namespace mortise {

/// Moves a surface to the least sum of squared distances of the points (Levenberg-Marquardt on
/// orthogonal distances, analytic derivatives). From a start within its basin it converges to
/// rounding for points that lie on a surface of this kind. `inward` is kept. It stops when a step
/// reduces the cost by less than worth_going_on, and gives up when the points are farther off than
/// hopeless_mm (root mean square) after a few steps. A surface that degenerates (an unbounded
/// radius, a cone without angle) gives nothing. O(iterations n).
std::optional<Surface> fitted_surface(const Surface& start, std::span<const Vec3> points,
                                      double worth_going_on = 1e-6, double hopeless_mm = 1e300);

/// Distances of points from a surface: the largest, and the root mean square.
struct Residuals {
  double most_mm = 0.0, mean_mm = 0.0;
};
Residuals residuals_of(const Surface& surface, std::span<const Vec3> points);

/// Largest distance of a point from the surface, mm.
double residual_of(const Surface& surface, std::span<const Vec3> points);

}  // namespace mortise
