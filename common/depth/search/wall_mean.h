#pragma once
#include "common/depth/search/patch.h"

namespace mortise {

/// A wall of K whose depth is a convex function of the point: a plane, or a surface that is hollow.
/// Frame K, mm.
struct ConvexWall {
  const Surface* surface = nullptr;  ///< inward; null: the plane through `point`
  Vec3 normal = Vec3::Zero();        ///< outward, at the patch
  Vec3 point = Vec3::Zero();
  double offset_mm = 0.0;  ///< outward, of the layer
  double turn_rad = 0.0;   ///< by which the wall's normal turns over the patch
  double depth_mm(const Vec3& x) const {
    return offset_mm -
           (surface != nullptr ? surface->signed_distance_mm(x) : normal.dot(x - point));
  }
};

/// True implies: no point of the patch is deeper than limit_mm below both walls at once, where K
/// lies below both. So a patch is parted from an edge of K, or from the rim of a bore, past which
/// it reaches on both sides. Depth below both is the lesser of the two, so any mean of them bounds
/// it; the mean of convex functions is largest at a point of the patch's hull, or on its circles.
/// O(points + circles).
bool mean_keeps_off(const ConvexWall& first, const ConvexWall& second, const Patch& patch,
                    double limit_mm);

}  // namespace mortise
