#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"
#include "common/geometry/surface_at.h"

/// What triangles show of a surface.
namespace mortise {

/// What a region shows of its surface; angles about the axis (sphere: about the best axis).
struct RegionMeasure {
  std::uint32_t steps = 0;           ///< facets around: distinct corner angles, less one when open
  double arc_rad = 0.0;              ///< 2 pi: closed
  Interval along_mm;                 ///< from surface.point along surface.axis
  std::vector<double> meridian_rad;  ///< torus: distinct corner angles of the tube, ascending
  bool one_row = false;              ///< all corners on two circles about the axis
};

/// Length to which the allowance of a surface is proportional: its radius; torus: of the tube;
/// cone: the largest radius of the triangles.
double size_mm(const Surface& surface, const TriangleMesh& mesh,
               std::span<const std::uint32_t> triangles);
/// The same of the corners of the triangles.
double size_mm(const Surface& surface, std::span<const Vec3> corners);

RegionMeasure measure_region(const TriangleMesh& mesh, const Surface& surface,
                             std::span<const std::uint32_t> triangles);

/// RegionMeasure::one_row alone.
bool lie_in_one_row(const TriangleMesh& mesh, const Surface& surface,
                    std::span<const std::uint32_t> triangles);

/// Do these corners, each off by no more than off_mm, lie on one surface of second degree only?
/// Those on two plane curves lie on many: two planes together are one, so a ball through the
/// corners of a low pyramid is chance. O(n).
bool fix_one_quadric(std::span<const Vec3> corners, double off_mm);

/// RegionMeasure::along_mm alone.
Interval extent_along_mm(const TriangleMesh& mesh, const Surface& surface,
                         std::span<const std::uint32_t> triangles);

/// Largest distance of a facet from the surface, mm; sampled, within a few percent from below.
double chord_error_mm(const TriangleMesh& mesh, const Surface& surface,
                      std::span<const std::uint32_t> triangles);

/// Normals of the surface at two of these corners, which lie on it, differ by no more than normals
/// of a ball of this radius at corners as far from each other. mm; not for planes.
double least_radius_mm(const Surface& surface, const Vec3& a, const Vec3& b, const Vec3& c);

double distance_from_axis_mm(const Surface& surface, const Vec3& x);

/// Distance of a triangle from the surface at its middles, where it is largest or nearly so.
double depth_at_middles_mm(const TriangleMesh& mesh, const SurfaceAt& surface, std::uint32_t t);

}  // namespace mortise
