#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/solid.h"

namespace mortise {

/// Flat groups of triangles connected across edges: the polygons that a tessellator drew.
/// Recognition and estimated deviations work on them, so that the diagonal of a quad has no effect.
struct Facets {
  std::vector<std::uint32_t> of_triangle;  ///< facet of each triangle
  std::vector<std::uint32_t> begin;        ///< members of facet f: members[begin[f] .. begin[f+1])
  std::vector<std::uint32_t> members;      ///< triangles, ascending within a facet
  std::vector<Vec3> normal;                ///< unit, by area; zero when not `reliable`
  std::vector<double> area_mm2;
  std::vector<bool> reliable;  ///< wide enough that rounding does not turn its normal

  std::uint32_t count() const { return static_cast<std::uint32_t>(normal.size()); }
  std::span<const std::uint32_t> triangles(std::uint32_t facet) const {
    return std::span(members).subspan(begin[facet], begin[facet + 1] - begin[facet]);
  }
  /// Exterior angle between two facets, rad; 0 when the normal of either is not known.
  double angle_rad(std::uint32_t f, std::uint32_t g) const;
};

/// Groups grow from the largest triangle on, as long as corners lie in the plane of the group
/// within flat_mm. Deterministic. O(n log n).
Facets build_facets(const Solid& solid, double flat_mm);

/// Half the step of a decimal grid on which all coordinates lie (files with a fixed number of
/// decimals: 5e-4 mm for six of a metre); 0 when there is no such grid between 1e-6 and 1e-3 mm, or
/// too few coordinates to distinguish it from a design in round numbers. O(n).
double grid_quantum_mm(const TriangleMesh& mesh);

/// How far corners of one flat face may be off its plane: twice the rounding of the file's
/// coordinates (0: doubles), and a share of the extent.
double flat_allowance_mm(const Solid& solid, double quantum_mm);

}  // namespace mortise
