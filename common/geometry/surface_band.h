#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/face_of_triangle.h"
#include "common/geometry/feature.h"
#include "common/math/interval.h"

namespace mortise {

/// Where the real surface of one part may lie, face by face: outward offset from the mesh =
/// deviation(x) + tolerance. One band belongs to a part; a pair of parts with a fit of its own has
/// bands of its own. Built by evaluation, read by depth, which knows neither scenario nor standard.
struct SurfaceBand {
  struct Face {
    std::string name;  ///< feature name, empty for the rest of the part
    std::optional<Surface>
        surface;  ///< set: deviation is the exact e(x) of this surface + doubt_mm()
    double residual_mm = 0.0;
    Interval deviation_mm;  ///< where `surface` is not set: [0, s], [-s, 0], [-s, s]; where it is
                            ///< set: bound of e(x) +- residual over all triangles of the face
    Interval tolerance_mm;  ///< outward positive, of the modelled surface
    /// Diameter of the zone of the axis or centre, half of which is at either end of tolerance_mm.
    double position_mm = 0.0;
    bool position_grows = false;  ///< with the size, under a material condition
    /// tolerance_mm without the position, which does not grow.
    Interval size_mm() const {
      return tolerance_mm + Interval{0.5 * position_mm, -0.5 * position_mm};
    }
    DeviationGrade grade = DeviationGrade::kNominal;
    /// Of a face that is round only by estimate: how far its real surface may be off `surface`
    /// beside the residual, outward positive. Its flat facets are within.
    Interval unsure_mm;
    /// Feature whose statements hold for the face, counted from zero; -1: those of the rest.
    std::int32_t feature = -1;
    /// How far the true surface may be off `surface`, outward: a declared surface is the truth,
    /// whatever the corners of the mesh; a recognized one is known only as well as the corners fit.
    Interval doubt_mm() const {
      if (grade == DeviationGrade::kDeclaredFeature) return {};
      return unsure_mm + Interval{-residual_mm, residual_mm};
    }
    std::string tolerance_source;  ///< "Ø20 H7", "profile 0.1", "" when nothing is declared
  };
  /// faces[0] is the rest of the part. A band that nothing was said of: one face without offsets.
  std::vector<Face> faces = std::vector<Face>(1);
  FaceOfTriangle face_of_triangle;  ///< index into faces; empty: all triangles are faces[0]

  const Face& face_of(std::uint32_t triangle) const {
    return faces[face_of_triangle.empty() ? 0 : face_of_triangle[triangle]];
  }
  /// Outward offset of the real surface from mesh point x of a triangle. Exact for a face with a
  /// surface.
  Interval offset_mm(std::uint32_t triangle, const Vec3& x) const;
  /// Largest outward offset of any face, >= 0 for the band in which near pairs must be examined
  /// (mm).
  double largest_offset_mm = 0.0;
  /// How far corners are off across any facet for the rounding of the part's file: part of every
  /// deviation above.
  double quantum_mm = 0.0;
  /// Convex edges and corners travel farther than their faces (sharp zones, see tips.h): how far
  /// out of the mesh, mm. 0: none does.
  double largest_travel_mm = 0.0;
  /// How far outside of the mesh the real surface may be, anywhere.
  double farthest_mm() const { return std::max({0.0, largest_offset_mm, largest_travel_mm}); }
  /// No face has deviation or tolerance, but for that rounding: the mesh is the part.
  bool trivial = true;
};

/// A band without offsets: the mesh is taken for the surface.
inline SurfaceBand nominal_band() { return {}; }

/// faces is not empty, face_of_triangle names one of them for each triangle or is empty, every
/// offset is an interval: lo <= hi.
bool valid(const SurfaceBand& band, std::size_t triangles);

}  // namespace mortise
