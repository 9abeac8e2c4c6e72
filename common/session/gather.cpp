#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/math/rotation.h"
#include "common/session/tick_work.h"

namespace mortise {
namespace {

// What may be said of an increment before its part is known to turn too far in all.
Refusal check(const World& world, const Increment& increment) {
  const User* user = world.find(increment.user);
  if (!user || !user->present) return Refusal::kUnknownUser;
  // Asked before anything else: a repeated message is a repeat, whatever happened in between.
  if (increment.seq == user->last_seq) return Refusal::kDuplicate;
  if (increment.seq < user->last_seq) return Refusal::kStale;
  const Part* part = world.find(increment.part);
  if (!part) return Refusal::kUnknownPart;
  if (!part->moving) return Refusal::kPartIsStatic;
  if (part->holder != increment.user) return Refusal::kNotHolder;
  if (!increment.translation_mm.allFinite() || !increment.rotation_rad.allFinite())
    return Refusal::kNotFinite;
  if (increment.rotation_rad.norm() > kMaxRotationPerTick_rad) return Refusal::kRotationTooLarge;
  if (increment.translation_mm.norm() > world.max_jump_mm) return Refusal::kJumpTooLarge;
  return Refusal::kNone;
}

// Eq. (1) of the paper: X_new = dT X_current. OURS: dT turns about the reference point.
Pose applied(const Increment& increment, const Pose& X_WP, const Vec3& reference_P) {
  if (increment.rotation_rad.isZero(0.0)) return {X_WP.q, X_WP.p + increment.translation_mm};
  const Vec3 reference_W = X_WP * reference_P + increment.translation_mm;
  const Quat q = (rotation_exp(increment.rotation_rad) * X_WP.q).normalized();
  return {q, reference_W - q * reference_P};
}

// Does the motion move any point by more than the rounding of its own coordinates?
bool is_felt(const Motion& motion, double radius_mm) {
  const double extent_mm = motion.X_W0.p.norm() + radius_mm + motion.reference_P.norm();
  return motion.travel_upper_bound_mm(radius_mm, 0.0, 1.0) > 4.0 * kUnitRoundoff * extent_mm;
}

Move& move_of(const World& world, Scratch::Impl& work, std::uint32_t part) {
  std::int32_t& index = work.move_of_part[part];
  if (index < 0) {
    index = static_cast<std::int32_t>(work.moves.size());
    Move& move = work.moves.emplace_back();
    move.part = part;
    move.motion = still_motion(world.parts[part].X_WP);
  }
  return work.moves[static_cast<std::size_t>(index)];
}

}  // namespace

void gather(World& world, std::span<const Increment> increments, Scratch::Impl& work,
            StepReport& report) {
  StepCounters& counters = report.counters;
  counters.increments.in = increments.size();
  if (work.move_of_part.size() != world.parts.size())
    work.move_of_part.assign(world.parts.size(), -1);
  for (const Move& move : work.moves) work.move_of_part[move.part] = -1;
  work.moves.clear();

  // 1. Check and compose, in order of arrival. motion.X_W1 is the target so far.
  for (const Increment& increment : increments) {
    Refusal refusal = check(world, increment);
    if (refusal == Refusal::kNone) {
      const std::uint32_t index = increment.part.value - 1;
      Move& move = move_of(world, work, index);
      // The path of a tick turns by the shortest way: more than half a turn in all would go the
      // other way round.
      const double turned_rad = move.turned_rad + increment.rotation_rad.norm();
      if (turned_rad > kMaxRotationPerTick_rad) {
        refusal = Refusal::kRotationTooLarge;
      } else {
        move.user = increment.user;
        move.turned_rad = turned_rad;
        move.motion.X_W1 =
            applied(increment, move.motion.X_W1, world.parts[index].solid->sphere().center_mm);
        world.find(increment.user)->last_seq = increment.seq;
        ++counters.increments.out;
        continue;
      }
    }
    ++counters.refused[static_cast<std::size_t>(refusal)];
    report.refused.push_back({increment.user, increment.part, increment.seq, refusal});
  }

  // 2. One motion a part; what nobody could feel is no motion.
  counters.moves.in = work.moves.size();
  for (Move& move : work.moves) {
    const BoundingSphere& sphere = world.parts[move.part].solid->sphere();
    const Motion motion = linear_motion(move.motion.X_W0, move.motion.X_W1, sphere.center_mm);
    if (motion.moves() && is_felt(motion, sphere.radius_mm)) {
      move.motion = motion;
      ++counters.moves.out;
    } else {
      move.motion = still_motion(move.motion.X_W0);
      ++counters.moves_below_rounding;
    }
    move.motion.reference_P = sphere.center_mm;
  }

  // 3. Parts that were put somewhere have to be looked at as well.
  for (const std::uint32_t part : world.state->placed) {
    Move& move = move_of(world, work, part);
    move.placed = true;
    move.motion.reference_P = world.parts[part].solid->sphere().center_mm;
  }
  for (const Move& move : work.moves) work.move_of_part[move.part] = -1;
  std::erase_if(work.moves, [](const Move& move) { return !move.motion.moves() && !move.placed; });
  std::sort(work.moves.begin(), work.moves.end(),
            [](const Move& x, const Move& y) { return x.part < y.part; });
  work.moved_parts.clear();
  for (std::size_t i = 0; i < work.moves.size(); ++i) {
    Move& move = work.moves[i];
    move.X_WP_end = move.motion.X_W1;
    work.move_of_part[move.part] = static_cast<std::int32_t>(i);
    work.moved_parts.push_back(move.part);
  }
}

}  // namespace mortise
