#pragma once
#include <functional>

#include "common/depth/cells/convex_cell.h"
#include "common/geometry/solid.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

namespace mortise::gpd {

/// A convex body by its points that are farthest along directions of the world.
struct ConvexBody {
  std::function<Vec3(const Vec3& n_W)> farthest;
  Vec3 middle_W = Vec3::Zero();
  double radius_mm = 0.0;  ///< about the middle: all of it is within
  double scale_mm = 0.0;   ///< of the coordinates that it is made of, for rounding
};

/// They refer to what they are made of.
ConvexBody hull_of(const Solid& part, const Pose& X_W);
ConvexBody hull_of(const ConvexCell& cell, const Pose& X_W);

/// The least translation that parts two convex bodies. World frame.
struct HullDepth {
  Interval depth_mm;              ///< of that translation; [0, 0] where they are apart
  Vec3 normal_W = Vec3::UnitZ();  ///< A moved along it by depth_mm.hi touches at most
  std::uint64_t supports = 0;     ///< directions asked
};

/// Expands a polytope within the Minkowski difference of the bodies where it is nearest to the
/// origin (van den Bergen 2001). Both ends are true wherever it stops: the polytope lies within the
/// difference, and each direction that was asked bounds the depth from above. Stops when they agree
/// to accuracy_mm, or after most_supports.
HullDepth hull_depth(const ConvexBody& a, const ConvexBody& b, double accuracy_mm,
                     int most_supports = 600);

/// Of the hulls of two parts.
inline HullDepth hull_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                            double accuracy_mm, int most_supports = 600) {
  return hull_depth(hull_of(a, X_WA), hull_of(b, X_WB), accuracy_mm, most_supports);
}

}  // namespace mortise::gpd
