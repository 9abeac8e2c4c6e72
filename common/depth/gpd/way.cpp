#include "common/depth/gpd/way.h"

#include <algorithm>

namespace mortise {
namespace {

// Places of the way at which the overlap is looked at.
constexpr int kPlaces = 12;

// Depth of the meshes, no less than it is known to be, or no more.
struct Depth {
  double least_mm = 0.0, most_mm = 0.0;
};
Depth depth_at(const OverlapQuery& query, CcdScratch& scratch) {
  Depth depth;
  for (const OverlapRegion& region : find_overlap(query, scratch).regions) {
    depth.least_mm = std::max(depth.least_mm, region.delta_mm.lo);
    depth.most_mm = std::max(depth.most_mm, region.delta_mm.hi);
  }
  return depth;
}

}  // namespace

bool way_goes_deeper(const OverlapQuery& start, const SeparatingMotion& motion,
                     CcdScratch& scratch) {
  const SurfaceBand nominal = nominal_band();
  OverlapQuery query = start;
  query.band_a = query.band_b = &nominal;
  const Solid& mover = motion.of_b ? *start.b : *start.a;
  const Motion path = motion.path(motion.of_b ? start.X_WB : start.X_WA, mover);
  // 1. back from the end to the last contact: beyond it the way is free
  ContactQuery back;
  back.a = &mover;
  back.b = motion.of_b ? start.a : start.b;
  back.motion_a = motion.backward(path.X_W0, mover);
  back.motion_b = still_motion(motion.of_b ? start.X_WA : start.X_WB);
  const FirstContact last = first_contact(back, scratch);
  const double t_last = last.state == ContactState::kFree ? 0.0 : 1.0 - last.t_clear;
  // 2. until then it may not get deeper
  const double most_mm = depth_at(query, scratch).most_mm + query.accuracy_mm;
  for (int i = 1; i < kPlaces; ++i) {
    const Pose X = path.pose_at(t_last * i / kPlaces);
    (motion.of_b ? query.X_WB : query.X_WA) = X;
    if (depth_at(query, scratch).least_mm > most_mm) return true;
  }
  return false;
}

std::optional<double> met_on_way(const Solid& part, const Pose& X_WP,
                                 const SeparatingMotion& motion, const Solid& other,
                                 const Pose& X_WO, CcdScratch& scratch) {
  ContactQuery query;
  query.a = &part;
  query.b = &other;
  query.motion_a = motion.path(X_WP, part);
  query.motion_b = still_motion(X_WO);
  query.ignore_touching_at_start = true;
  const FirstContact contact = first_contact(query, scratch);
  switch (contact.state) {
    case ContactState::kFree:
      return std::nullopt;
    case ContactState::kOverlappingAtStart:
      break;
    default:
      return contact.t_clear;
  }
  const SurfaceBand nominal = nominal_band();
  OverlapQuery overlap;
  overlap.a = &part;
  overlap.b = &other;
  overlap.band_a = overlap.band_b = &nominal;
  overlap.X_WA = X_WP;
  overlap.X_WB = X_WO;
  const Depth before = depth_at(overlap, scratch);
  overlap.X_WA = query.motion_a.X_W1;
  const Depth after = depth_at(overlap, scratch);
  if (after.least_mm > before.most_mm + overlap.accuracy_mm) return 0.0;
  return std::nullopt;
}

}  // namespace mortise
