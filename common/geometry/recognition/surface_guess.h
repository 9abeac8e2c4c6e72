#pragma once
#include <optional>
#include <span>

#include "common/geometry/feature.h"

namespace mortise {

/// A point of a mesh with the outward normal of the facet around it; part frame, mm.
struct OrientedPoint {
  Vec3 point;
  Vec3 normal;
};

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
