#include "common/session/memory/kept_push.h"

#include <algorithm>

#include "common/base/constants.h"
#include "common/math/rotation.h"
#include "common/session/tick/stop_time.h"

namespace mortise {
namespace {

// Does it wait for work, with every pair that holds it back?
bool waits(const Scratch::Impl& work, std::int32_t index) {
  bool any = false;
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    const PairWork& pair = work.pairs[i];
    if (!pair.status.blocks || (pair.ids.move_a != index && pair.ids.move_b != index)) continue;
    const bool had_none =
        pair.effort.contact_waits ||
        (pair.answer.short_of_work && pair.effort.cap == 0 && times_in_vain(pair) == 0);
    if (!had_none) return false;
    any = true;
  }
  return any;
}

double shortened(Vec3& by, double most) {
  const double length = by.norm();
  if (length > most) by *= most / length;
  return length - by.norm();
}

}  // namespace

std::vector<KeptPush> kept_pushes(const World& world, const Scratch::Impl& work,
                                  StepCounters& counters) {
  std::vector<KeptPush> kept;
  for (std::size_t i = 0; i < work.moves.size(); ++i) {
    const Move& move = work.moves[i];
    if (!move.stopped || move.group || move.sliding >= 0) continue;
    if (!waits(work, static_cast<std::int32_t>(i))) continue;
    const Pose &X_W0 = move.X_WP_end, &X_W1 = move.motion.X_W1;
    // About which gather turns it: a guided motion may have turned about a point of its axis.
    const Vec3& reference_P = world.parts[move.part].solid->sphere().center_mm;
    KeptPush push{move.part, move.user, X_W0, X_W1 * reference_P - X_W0 * reference_P,
                  rotation_log((X_W1.q * X_W0.q.conjugate()).normalized())};
    const double cut_mm = shortened(push.shift_mm, world.max_jump_mm);
    const double cut_rad = shortened(push.turn_rad, 0.5 * kMaxRotationPerTick_rad);
    if (cut_mm > 0.0 || cut_rad > 0.0) ++counters.pushes_cut;
    kept.push_back(push);
  }
  return kept;
}

}  // namespace mortise
