#pragma once
#include <span>

#include "common/depth/overlap.h"

namespace mortise {

struct GpdQuery {
  OverlapQuery overlap;  ///< parts, bands and target poses
  const OverlapRegion* region = nullptr;
  std::span<const OverlapRegion> regions;  ///< all of the pair, which must come free with it; may
                                           ///< be empty
  Motion motion_a, motion_b;               ///< of the tick; still when judged without a motion
  double t_contact = 1.0;                  ///< of the pair
  std::uint64_t work_cap = 4'000;          ///< evaluations of all proofs that a pose is free
};

/// Generalized penetration depth of a region (README, section 7).
/// gpd_mm.lo = delta.lo: any separating motion moves some point at least that far.
/// gpd_mm.hi = least over verified separating motions of the largest path length of any point of A:
/// back along the tick, along the region normal, rotation + translation fitted to the region's
/// points, and, where a face is concave or several hold the other part between them, along the axis
/// of the round face or along what all surfaces of the region go on along. Infinity when none was
/// verified. Only the end of a motion is verified to be free; the way there may pass through.
/// [0, 0] where the meshes of the region are apart and only their zones meet.
struct GeneralizedDepth {
  Interval gpd_mm;
  SeparationWay way = SeparationWay::kNone;
  Vec3 translation_mm = Vec3::Zero();  ///< of A's reference point, world axes
  Vec3 rotation_rad = Vec3::Zero();
  double travel_mm = 0.0;  ///< path length from contact to target, largest over the region's points
  double normal_travel_mm = 0.0;
  std::uint64_t evaluations = 0;
};

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch);

}  // namespace mortise
