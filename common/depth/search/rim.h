#pragma once
#include <span>

#include "common/depth/body.h"

namespace mortise {

/// The circle in which a bore of a part ends in a plane. Points of either face near it are neither
/// inside the cylinder nor above the plane. mm.
struct Rim {
  Vec3 center = Vec3::Zero();  ///< of its circle
  Vec3 axis = Vec3::UnitZ();   ///< of the bore, unit, out of the material
  double radius_mm = 0.0;

  Rim seen_from(const Pose& X) const { return {X * center, X.q * axis, radius_mm}; }
};

/// Fills `rims` with the rims on which a triangle ends in the layer and returns their number; more
/// than fit are left out. None on the mesh, whose bores are not cylinders. Part frame.
int rims_of(const Body& s, Layer layer, std::uint32_t triangle, std::span<Rim> rims);

/// No point that is neither inside the rim's cylinder nor above its plane is deeper than this below
/// a convex cone or cylinder, mm. Closed form: each such point is compared with the tangent plane
/// that faces it; exact where the axes are parallel, else to second order of the tilt. The points
/// end below_mm under the rim, which matters for a tilted cylinder. Infinite where a cone does not
/// narrow into the bore. One frame. OURS.
double depth_at_rim_mm(const Rim& rim, const Surface& round, double below_mm);

/// The same from one pose to another, along which no point is farther than spread_mm from the
/// straight line between its ends and directions turn by no more than turn_rad.
double depth_at_rim_mm(const Rim& from, const Rim& to, const Surface& round, double below_mm,
                       double turn_rad, double spread_mm);

}  // namespace mortise
