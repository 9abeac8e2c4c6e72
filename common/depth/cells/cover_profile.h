#pragma once
#include <vector>

#include "common/depth/cells/cover_faces.h"
#include "common/depth/cells/cover_outside.h"

namespace mortise {

/// The triangles of one cylinder along an axis, and the directions of its tangents there.
struct ProfileArc {
  const Surface* surface = nullptr;
  std::vector<std::uint32_t> triangles;
  std::vector<bool> has_point;  ///< by point of the mesh: of such a triangle
  LayerOffsets offsets{};
  double residual_mm = 0.0, tilt_mm = 0.0;  ///< of the mesh; of the axis, over the part
  Arc arc;                                  ///< across the axis

  /// How far x is beyond the farthest of its tangents, outwards of the axis.
  double beyond_mm(const Vec3& x) const;
};

/// The cylinders along an axis that are all bores, or none of them; a face of another axis is none.
std::vector<ProfileArc> profile_arcs(const CoverFaces& faces, const Vec3& axis, bool inward);

/// Is n the direction of a tangent of the arc, but for less than an angle with this cosine?
bool goes_on(const Arc& arc, const Vec3& n, double cosine);

/// One prism along the largest outer cylinder: below the planes along it that have all of the part
/// on one side, and round where its cylinders are. Empty: it has none.
Outside profile_outside(const CoverFaces& faces);

}  // namespace mortise
