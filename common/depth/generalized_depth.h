#pragma once
#include <span>

#include "common/depth/overlap.h"

namespace mortise {

/// A motion of one part of a pair, the other stays. World frame. The part turns about `about_W`
/// with a constant rotation while that point moves on, along a screw: exp(s ξ), s from 0 to 1.
struct SeparatingMotion {
  bool of_b = false;                   ///< B is moved, not A
  Vec3 translation_mm = Vec3::Zero();  ///< from about_W to where that point ends
  Vec3 rotation_rad = Vec3::Zero();    ///< no more than half a turn
  Vec3 about_W = Vec3::Zero();

  /// What it does to points of the world that are fixed to the part, at its end.
  Pose displacement() const;
  /// From X_W to the end, in one tick, and the other way round.
  Motion path(const Pose& X_W, const Solid& part) const;
  Motion backward(const Pose& X_W, const Solid& part) const;
  bool moves() const { return !translation_mm.isZero(0.0) || !rotation_rad.isZero(0.0); }
};

/// Longest path of any point of the part (README, section 7), mm. X_W: where the part begins. Never
/// short, and long by 1e-9 of it at most.
double longest_path_mm(const Solid& part, const Pose& X_W, const SeparatingMotion& motion);

struct GpdQuery {
  OverlapQuery overlap;                    ///< parts, bands, target poses; kFull: a longer search
  std::span<const OverlapRegion> regions;  ///< all of the pair: a motion has to free them all
  bool b_moves = false;                    ///< the part that is held is the one that is moved out
  Motion motion_a, motion_b;               ///< of the tick; still when judged without a motion
  double t_contact = 1.0;                  ///< of the pair
  /// Known from before: it may part them. Then the answer is no longer than this motion.
  const SeparatingMotion* known = nullptr;
  std::uint64_t work_cap = 12'000;  ///< evaluations; where it ends, the bracket stays wider
};

/// Generalized penetration depth of a pair (README, section 7), for the part that is moved.
/// gpd_mm.lo: no motion parts the meshes without moving some point of the part at least so far. By
/// the overlap, by holds and pieces, and by the hulls where both parts are convex.
/// gpd_mm.hi: the longest path of any point under `motion`, which parts them. Finite. Verified at
/// its end: surfaces do not cross, neither part contains the other; the way may pass through.
/// lo = hi, but for rounding and a gap of 1e-7 mm, where both parts are convex.
/// [0, 0] where the meshes are apart and only their zones meet.
struct GeneralizedDepth {
  Interval gpd_mm;
  SeparationWay way = SeparationWay::kNone;
  SeparatingMotion motion;
  std::uint64_t evaluations = 0;
};

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch);

/// How far a region has come in since the contact: the motion of A seen from B, mm.
struct TravelSinceContact {
  double path_mm = 0.0;    ///< path from contact to target, largest over the region's points
  double normal_mm = 0.0;  ///< its part along the normal, likewise
};
TravelSinceContact travel_since_contact(const OverlapRegion& region, const Motion& motion_a,
                                        const Motion& motion_b, double t_contact);

}  // namespace mortise
