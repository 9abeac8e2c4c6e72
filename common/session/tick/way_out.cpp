#include "common/session/tick/way_out.h"

#include <cmath>

#include "common/broadphase/swept_box.h"
#include "common/depth/depth.h"

namespace mortise {

SeparatingMotion way_out(const Verdict& verdict) {
  SeparatingMotion motion;
  motion.of_b = verdict.separation_of_b;
  motion.translation_mm = verdict.separation_translation_mm;
  motion.rotation_rad = verdict.separation_rotation_rad;
  motion.about_W = verdict.separation_about_W;
  return motion;
}

namespace {

// What a motion meets; none: kUnknown.
struct Met {
  SeparationPath path = SeparationPath::kUnknown;
  PartId blocker;
};

// kFirst: the first part that is met. kAny: one of them.
enum class Sought : std::uint8_t { kFirst = 0, kAny };

Met look_along(const World& world, PartId a, PartId b, const OverlapQuery& start, double depth_mm,
               const SeparatingMotion& motion, Sought sought, CcdScratch& scratch) {
  const Part& mover = *world.find(motion.of_b ? b : a);
  const Motion path = motion.path(mover.X_WP, *mover.solid);
  const Box swept =
      swept_box({mover.solid->bounds(), mover.solid->sphere()}, path).grown(kAccuracyDefault_mm);
  double first = 2.0;
  Met met;
  for (const Part& other : world.parts) {
    if (!other.present || other.id == a || other.id == b) continue;
    const PairRule* rule = world.rule(mover.id, other.id);
    if (rule != nullptr && rule->excluded) continue;
    const BodyBounds body{other.solid->bounds(), other.solid->sphere()};
    if (!swept.overlaps(swept_box(body, still_motion(other.X_WP)))) continue;
    const auto at = met_on_way(*mover.solid, mover.X_WP, motion, *other.solid, other.X_WP, scratch);
    if (!at || !(*at < first)) continue;
    first = *at;
    met = {SeparationPath::kBlocked, other.id};
    if (first <= 0.0 || sought == Sought::kAny) break;
  }
  if (met.path != SeparationPath::kBlocked)
    met.path = way_goes_deeper(start, depth_mm, motion, scratch) ? SeparationPath::kDeeper
                                                                 : SeparationPath::kFree;
  return met;
}

// What the way of a motion is called that is as long as the one that was told.
SeparationWay way_of(const SeparatingMotion& motion, const Verdict& verdict) {
  if (!motion.rotation_rad.isZero(0.0)) return verdict.separation_way;
  const auto along = [&](const Vec3& line) {
    return std::fabs(motion.translation_mm.dot(line)) >
           (1.0 - 1e-8) * motion.translation_mm.norm() * line.norm();
  };
  if (verdict.separation_way == SeparationWay::kAxis && along(verdict.separation_translation_mm))
    return SeparationWay::kAxis;
  return along(verdict.normal_W) ? SeparationWay::kNormal : SeparationWay::kStraight;
}

}  // namespace

void look_along_way(const World& world, PartId a, PartId b, double depth_mm, Verdict& verdict,
                    CcdScratch& scratch) {
  verdict.separation_path = SeparationPath::kUnknown;
  verdict.separation_blocker = PartId{};
  const SeparatingMotion motion = way_out(verdict);
  if (verdict.separation_way == SeparationWay::kNone || !motion.moves()) return;
  OverlapQuery start;
  start.a = world.find(a)->solid.get();
  start.b = world.find(b)->solid.get();
  start.X_WA = world.find(a)->X_WP;
  start.X_WB = world.find(b)->X_WP;
  const Met met = look_along(world, a, b, start, depth_mm, motion, Sought::kFirst, scratch);
  verdict.separation_path = met.path;
  verdict.separation_blocker = met.blocker;
  if (met.path == SeparationPath::kFree) return;
  // Among those that are as long one may be free.
  for (const SeparatingMotion& way : ways_as_long(start, motion, verdict.gpd_mm.hi, scratch)) {
    if (look_along(world, a, b, start, depth_mm, way, Sought::kAny, scratch).path !=
        SeparationPath::kFree)
      continue;
    verdict.separation_way = way_of(way, verdict);
    verdict.separation_translation_mm = way.translation_mm;
    verdict.separation_rotation_rad = way.rotation_rad;
    verdict.separation_path = SeparationPath::kFree;
    verdict.separation_blocker = PartId{};
    return;
  }
}

}  // namespace mortise
