#pragma once
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/facets.h"
#include "common/geometry/surface_fit.h"

/// Private to recognition: triangles that stand for one surface.
namespace mortise {

struct Region {
  Surface surface;
  std::vector<std::uint32_t> triangles;  ///< ascending
  double residual_mm = 0.0;
  double allowed_mm = 0.0;  ///< how far corners could be off
  double share = 0.0;       ///< of the size, without rounding
};

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

RegionMeasure measure_region(const TriangleMesh& mesh, const Surface& surface,
                             std::span<const std::uint32_t> triangles);

/// Farthest that a facet stands off the surface, mm; sampled, within a few percent from below.
double chord_error_mm(const TriangleMesh& mesh, const Surface& surface,
                      std::span<const std::uint32_t> triangles);

/// Grows regions over smooth edges. Holds marks of its own: one per thread.
class RegionGrower {
 public:
  RegionGrower(const Solid& solid, const Facets& facets, double quantum_mm);

  /// The region of a surface fitted to seed triangles: grown in doubling steps with a fit after
  /// each, cut back to corners within share * size + rounding. Nothing when fewer than
  /// the seeds remain, or when the region shows too little of the surface to tell it.
  std::optional<Region> grow(const Surface& guess, std::span<const std::uint32_t> seeds,
                             double share);

  /// Fits the surface to what the region has now; false when it no longer holds.
  bool settle(Region& region);

  /// The corners of triangles, each once, in order of appearance.
  std::vector<Vec3> points_of(std::span<const std::uint32_t> triangles);
  /// Middle and facet normal of triangles whose normal is known.
  std::vector<OrientedPoint> normals_of(std::span<const std::uint32_t> triangles) const;

  /// Rounding of coordinates: corners may be off by this beside any share of the size.
  double rounding_mm() const { return rounding_mm_; }
  bool smooth(std::uint32_t facet_a, std::uint32_t facet_b) const;

 private:
  bool belongs(std::uint32_t t, const Surface& surface, double allowed_mm) const;
  void spread(const Surface& surface, double allowed_mm, std::size_t limit,
              std::vector<std::uint32_t>& triangles);
  bool refit(Region& region, std::size_t most = 100'000);
  void drop_deep_facets(Region& region) const;
  bool shows_enough(const Region& region);
  bool shows_enough_of_sphere(const Region& region) const;
  bool shows_enough_of_torus(const Region& region, const RegionMeasure& m) const;

  const TriangleMesh& mesh_;
  const Topology& topology_;
  const Facets& facets_;
  double rounding_mm_ = 0.0;
  std::vector<std::uint32_t> triangle_mark_, point_mark_;
  std::uint32_t mark_ = 0;
};

}  // namespace mortise
