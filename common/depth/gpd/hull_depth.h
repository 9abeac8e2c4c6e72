#pragma once
#include "common/geometry/solid.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

namespace mortise::gpd {

/// The least translation that parts the convex hulls of two meshes. World frame.
struct HullDepth {
  Interval depth_mm;              ///< of that translation; [0, 0] where the hulls are apart
  Vec3 normal_W = Vec3::UnitZ();  ///< A moved along it by depth_mm.hi touches at most
  std::uint64_t supports = 0;     ///< directions asked
};

/// Expands a polytope within the Minkowski difference of the hulls where it is nearest to the
/// origin (van den Bergen 2001). Both ends are true wherever it stops: the polytope lies within the
/// difference, and each direction that was asked bounds the depth from above. Stops when they agree
/// to accuracy_mm, or after most_supports.
HullDepth hull_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                     double accuracy_mm, int most_supports = 600);

}  // namespace mortise::gpd
