#pragma once
#include <span>

#include "common/depth/body.h"

namespace mortise {

/// Where a bore of a part ends in a plane. What lies near it of either face is neither inside the
/// cylinder nor above the plane. mm.
struct Rim {
  Vec3 center = Vec3::Zero();  ///< of its circle
  Vec3 axis = Vec3::UnitZ();   ///< of the bore, unit, out of the material
  double radius_mm = 0.0;

  Rim seen_from(const Pose& X) const { return {X * center, X.q * axis, radius_mm}; }
};

/// Those that a triangle ends on in the layer, as many as there is room for; how many. None on the
/// mesh, whose bores are no cylinders. Part frame.
int rims_of(const Body& s, Layer layer, std::uint32_t triangle, std::span<Rim> rims);

/// No point that is neither inside the rim's cylinder nor above its plane is deeper than this below
/// a convex cone or cylinder, mm. Closed form: each such point is held against the tangent plane
/// that faces it; exact where the axes are parallel, else to second order of the tilt. The points
/// end below_mm under the rim, which counts for a tilted cylinder. Infinite where a cone does not
/// narrow into the bore. One frame. OURS.
double depth_at_rim_mm(const Rim& rim, const Surface& round, double below_mm);

/// The same from one pose to another, along which no point is farther than spread_mm from the
/// straight line between its ends and directions turn by no more than turn_rad.
double depth_at_rim_mm(const Rim& from, const Rim& to, const Surface& round, double below_mm,
                       double turn_rad, double spread_mm);

}  // namespace mortise
