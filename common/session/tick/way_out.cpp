#include "common/session/tick/way_out.h"

#include "common/broadphase/swept_box.h"
#include "common/depth/gpd/way.h"

namespace mortise {

SeparatingMotion way_out(const Verdict& verdict) {
  SeparatingMotion motion;
  motion.of_b = verdict.separation_of_b;
  motion.translation_mm = verdict.separation_translation_mm;
  motion.rotation_rad = verdict.separation_rotation_rad;
  motion.about_W = verdict.separation_about_W;
  return motion;
}

void look_along_way(const World& world, PartId a, PartId b, double depth_mm, Verdict& verdict,
                    CcdScratch& scratch) {
  verdict.separation_path = SeparationPath::kUnknown;
  verdict.separation_blocker = PartId{};
  const SeparatingMotion motion = way_out(verdict);
  if (verdict.separation_way == SeparationWay::kNone || !motion.moves()) return;
  const Part& mover = *world.find(motion.of_b ? b : a);
  const Motion path = motion.path(mover.X_WP, *mover.solid);
  const Box swept =
      swept_box({mover.solid->bounds(), mover.solid->sphere()}, path).grown(kAccuracyDefault_mm);
  double first = 2.0;
  for (const Part& other : world.parts) {
    if (other.id == a || other.id == b) continue;
    const PairRule* rule = world.rule(mover.id, other.id);
    if (rule != nullptr && rule->excluded) continue;
    const BodyBounds body{other.solid->bounds(), other.solid->sphere()};
    if (!swept.overlaps(swept_box(body, still_motion(other.X_WP)))) continue;
    const auto met =
        met_on_way(*mover.solid, mover.X_WP, motion, *other.solid, other.X_WP, scratch);
    if (!met || !(*met < first)) continue;
    first = *met;
    verdict.separation_path = SeparationPath::kBlocked;
    verdict.separation_blocker = other.id;
  }
  if (verdict.separation_path == SeparationPath::kBlocked) return;
  OverlapQuery start;
  start.a = world.find(a)->solid.get();
  start.b = world.find(b)->solid.get();
  start.X_WA = world.find(a)->X_WP;
  start.X_WB = world.find(b)->X_WP;
  verdict.separation_path = way_goes_deeper(start, depth_mm, motion, scratch)
                                ? SeparationPath::kDeeper
                                : SeparationPath::kFree;
}

}  // namespace mortise
