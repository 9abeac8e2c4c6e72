#pragma once
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/feature.h"

namespace mortise {

/// A point of a mesh with the outward normal of the facet around it; part frame, mm.
struct OrientedPoint {
  Vec3 point;
  Vec3 normal;
};

/// Moves a surface to the least sum of squared distances of the points (Levenberg-Marquardt on
/// orthogonal distances, analytic derivatives). From a start within its basin it converges to
/// rounding for points that lie on a surface of this kind. `inward` is kept. It stops when a step
/// reduces the cost by less than worth_going_on, and gives up when the points are farther off than
/// hopeless_mm (root mean square) after a few steps. A surface that degenerates (an unbounded
/// radius, a cone without angle) gives nothing. O(iterations n).
std::optional<Surface> fitted_surface(const Surface& start, std::span<const Vec3> points,
                                      double worth_going_on = 1e-6, double hopeless_mm = 1e300);

/// Largest distance of a point from the surface, mm.
double residual_of(const Surface& surface, std::span<const Vec3> points);

/// The unit direction along which normals vary least, counted from `about`: the axis of a cylinder
/// (about zero) or a cone (about their mean). Nothing when the normals hardly vary.
std::optional<Vec3> steady_direction(std::span<const OrientedPoint> facets, const Vec3& about);

/// First guesses. Each needs a few points and facets of one surface, and gives nothing where these
/// do not determine it. Not refined; exact for a sphere, and for cylinders and cones with symmetric
/// facets.
std::optional<Surface> guess_cylinder(std::span<const Vec3> points,
                                      std::span<const OrientedPoint> facets);
std::optional<Surface> guess_cone(std::span<const Vec3> points,
                                  std::span<const OrientedPoint> facets);
std::optional<Surface> guess_sphere(std::span<const Vec3> points);
/// By the line complex of the normals (Pottmann and Randrup 1998): the normals of a surface of
/// revolution meet its axis.
std::optional<Surface> guess_torus(std::span<const Vec3> points,
                                   std::span<const OrientedPoint> facets);

/// A torus about an axis that is known from a strip of it: the circle through the meridian.
std::optional<Surface> guess_torus_about(const Surface& strip, std::span<const Vec3> points);

}  // namespace mortise
