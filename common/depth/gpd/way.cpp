#include "common/depth/gpd/way.h"

#include <algorithm>

namespace mortise {
namespace {

// Places of the way at which the overlap is looked at.
constexpr int kPlaces = 12;

// Work of one look.
constexpr std::uint64_t kLookWork = 2'000;

// What the meshes are known to overlap by at least, or at most.
Interval depth_at(const OverlapQuery& query, CcdScratch& scratch) {
  Interval depth;
  for (const OverlapRegion& region : find_overlap(query, scratch).regions)
    depth = {std::max(depth.lo, region.delta_mm.lo), std::max(depth.hi, region.delta_mm.hi)};
  return depth;
}

// Somewhere on the path of one of the two parts, up to t_end.
bool deeper_along(OverlapQuery query, const Motion& path, bool of_b, double t_end, double most_mm,
                  CcdScratch& scratch) {
  const SurfaceBand nominal = nominal_band();
  query.band_a = query.band_b = &nominal;
  query.work_cap = kLookWork;
  for (int i = 1; i <= kPlaces; ++i) {
    (of_b ? query.X_WB : query.X_WA) = path.pose_at(t_end * i / kPlaces);
    if (depth_at(query, scratch).lo > most_mm + query.accuracy_mm) return true;
  }
  return false;
}

}  // namespace

bool way_goes_deeper(const OverlapQuery& start, double depth_mm, const SeparatingMotion& motion,
                     CcdScratch& scratch) {
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
  return deeper_along(start, path, motion.of_b, t_last, depth_mm, scratch);
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
  overlap.work_cap = kLookWork;
  const double most_mm = depth_at(overlap, scratch).hi;
  if (deeper_along(overlap, query.motion_a, false, 1.0, most_mm, scratch)) return 0.0;
  return std::nullopt;
}

}  // namespace mortise
