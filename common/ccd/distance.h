#pragma once
#include <cstdint>
#include <limits>

#include "common/ccd/ccd_scratch.h"
#include "common/geometry/solid.h"
#include "common/math/pose.h"

namespace mortise {

struct DistanceResult {
  double distance_mm = 0.0;  ///< 0 when the surfaces cross or touch
  std::uint32_t triangle_a = 0, triangle_b = 0;
  Vec3 point_a_W = Vec3::Zero(), point_b_W = Vec3::Zero();
  bool within_limit =
      false;  ///< false: farther apart than limit_mm, distance_mm is then limit_mm (a lower bound)
};

/// Distance of two meshes at fixed poses, exact to rounding. `seed`: an answer about the same pair
/// at poses nearby; it makes the answer come sooner, no different (of several places that are
/// equally near another may be named). A seed that is no answer, or of other solids, is of no use
/// and does no harm.
DistanceResult distance(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                        CcdScratch& scratch,
                        double limit_mm = std::numeric_limits<double>::infinity(),
                        const DistanceResult* seed = nullptr);

/// Do the surfaces cross or touch (to rounding) at these poses? One part wholly inside the other
/// does not count: see contained().
bool surfaces_cross(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                    CcdScratch& scratch);

}  // namespace mortise
