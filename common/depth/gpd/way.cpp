#include "common/depth/depth.h"

#include <algorithm>
#include <cmath>

#include "common/depth/gpd/separation_search.h"

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

// Two directions are one, or opposite, when they differ by no more (cosine).
constexpr double kOneLine = 1.0 - 1e-8;

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

std::vector<SeparatingMotion> ways_as_long(const OverlapQuery& start,
                                           const SeparatingMotion& motion, double length_mm,
                                           CcdScratch& scratch) {
  const Solid &mover = motion.of_b ? *start.b : *start.a,
              &other = motion.of_b ? *start.a : *start.b;
  const Pose &X_mover = motion.of_b ? start.X_WB : start.X_WA,
             &X_other = motion.of_b ? start.X_WA : start.X_WB;
  std::vector<SeparatingMotion> ways;
  const auto try_way = [&](const Vec3& shift, const Vec3& turn) {
    SeparatingMotion way = motion;
    way.translation_mm = shift;
    way.rotation_rad = turn;
    if (longest_path_mm(mover, X_mover, way) <= length_mm * (1.0 + 1e-9) &&
        gpd::is_apart(mover, way.displacement() * X_mover, other, X_other, scratch))
      ways.push_back(way);
  };
  if (!motion.rotation_rad.isZero(0.0)) {
    try_way(-motion.translation_mm, motion.rotation_rad);
    try_way(motion.translation_mm, -motion.rotation_rad);
    try_way(-motion.translation_mm, -motion.rotation_rad);
  }
  std::vector<Vec3> lines;
  const auto add_line = [&](const Vec3& d) {
    if (std::none_of(lines.begin(), lines.end(),
                     [&](const Vec3& line) { return std::fabs(line.dot(d)) > kOneLine; }))
      lines.push_back(d);
  };
  if (motion.rotation_rad.isZero(0.0)) add_line(motion.translation_mm.normalized());
  for (const Vec3& n : mover.outline().main_normals) add_line(X_mover.q * n);
  for (const Vec3& n : other.outline().main_normals) add_line(X_other.q * n);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (const double sign : {-1.0, 1.0})
      if (i > 0 || sign < 0.0 || !motion.rotation_rad.isZero(0.0))
        try_way(sign * length_mm * lines[i], Vec3::Zero());
  return ways;
}

}  // namespace mortise
