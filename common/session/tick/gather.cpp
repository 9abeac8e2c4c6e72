#include "common/session/tick/gather.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/base/ranges.h"
#include "common/math/rotation.h"
#include "common/session/guide/guidance.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

// What may be said of an increment before its part is known to turn too far in all.
Refusal check(const World& world, const Increment& increment) {
  // Asked before anything else: a repeated message is a repeat, whatever happened in between.
  if (const User* user = world.find(increment.user); user && user->present) {
    if (increment.seq == user->last_seq) return Refusal::kDuplicate;
    if (increment.seq < user->last_seq) return Refusal::kStale;
  }
  return refusal_of(world, increment);
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

// Of a group its first part stands for all; its motion starts as that of a frame without a turn at
// the group's reference point.
struct Target {
  std::uint32_t part = 0;
  Pose X_W0;
  Vec3 reference_P = Vec3::Zero();
};

Target target_of(const World& world, std::uint32_t index) {
  const Part& part = world.parts[index];
  if (!part.group) return {index, part.X_WP, part.solid->sphere().center_mm};
  const MovingGroup group = moving_group_of(world, index);
  return {group.parts.front(), Pose::translation(group.reference_W), Vec3::Zero()};
}

Move& move_of(Scratch::Impl& work, const Target& target) {
  std::int32_t& index = work.move_of_part[target.part];
  if (index < 0) {
    index = static_cast<std::int32_t>(work.moves.size());
    Move& move = work.moves.emplace_back();
    move.part = target.part;
    move.motion = still_motion(target.X_W0);
    move.motion.reference_P = target.reference_P;
  }
  return work.moves[static_cast<std::size_t>(index)];
}

bool is_guided(const World& world, const Move& move) {
  if (world.guides.empty()) return false;
  const GroupId group = world.parts[move.part].group;
  return std::any_of(world.guides.begin(), world.guides.end(), [&](const Guide& guide) {
    const PartId held = guide.constraint.held.part;
    return held.value == move.part + 1 || (group && world.find(held)->group == group);
  });
}

// What was composed of the increments, as a displacement about the reference point of its group.
Displacement wanted_of(const Move& move) {
  const Pose &X_W0 = move.motion.X_W0, &X_W1 = move.motion.X_W1;
  const Vec3& reference_P = move.motion.reference_P;
  Displacement wanted;
  if ((X_W0.q.coeffs().array() == X_W1.q.coeffs().array()).all()) {
    wanted.shift_mm = X_W1.p - X_W0.p;
  } else {
    wanted.turn = (X_W1.q * X_W0.q.conjugate()).normalized();
    wanted.shift_mm = X_W1 * reference_P - X_W0 * reference_P;
  }
  return wanted;
}

// No farther than one increment may: what is a long way off its constraints comes in several ticks.
Displacement within_a_jump(const World& world, Displacement by) {
  const double length_mm = by.shift_mm.norm();
  if (length_mm <= world.max_jump_mm) return by;
  const double share = world.max_jump_mm / length_mm;
  return {rotation_exp(share * rotation_log(by.turn)), share * by.shift_mm};
}

// The motions of a guided part or of a group, one a part, all with one displacement: what the
// constraints leave of the wanted one. The first takes the place of the move that stood for all.
void spread(const World& world, std::size_t at, Scratch::Impl& work) {
  const MovingGroup group = moving_group_of(world, work.moves[at].part);
  const std::vector<Relation> relations = relations_of(world, group);
  Displacement by = wanted_of(work.moves[at]);
  if (!relations.empty()) {
    by = guided({relations, group.reference_W, group.lever_mm(), by}).displacement;
    by = within_a_jump(world, by);
  }
  const Vec3 center_W = straight_point(group, relations);
  by = about(by, group.reference_W, center_W);
  const std::size_t others = work.moves.size();
  for (const std::uint32_t part : group.parts) {
    if (part == work.moves[at].part) continue;
    const UserId user = work.moves[at].user;
    Move& move = work.moves.emplace_back();
    move.part = part;
    move.user = user;
  }
  bool felt = false;
  const auto each = [&](const auto& f) {
    f(work.moves[at]);
    for (std::size_t i = others; i < work.moves.size(); ++i) f(work.moves[i]);
  };
  each([&](Move& move) {
    const Part& part = world.parts[move.part];
    const BoundingSphere& sphere = part.solid->sphere();
    move.group = part.group;
    move.motion = rigid_motion(part.X_WP, center_W, by);
    felt |=
        move.motion.moves() &&
        is_felt(move.motion, (part.X_WP * sphere.center_mm - center_W).norm() + sphere.radius_mm);
  });
  if (felt) return;
  each([&](Move& move) {
    const Part& part = world.parts[move.part];
    move.motion = still_motion(part.X_WP);
    move.motion.reference_P = part.solid->sphere().center_mm;
  });
}

// Parts that go for their constraints without being pushed.
void follow(const World& world, Scratch::Impl& work) {
  for (const Guide& guide : world.guides) {
    const std::uint32_t part = guide.constraint.held.part.value - 1;
    if (!guide.follows) continue;
    const Target target = target_of(world, part);
    if (work.move_of_part[target.part] >= 0) continue;
    if (guided_state(world, guide.constraint.held.part).residual_mm <= kGuideAccuracy_mm) continue;
    move_of(work, target).user = world.parts[part].holder;
  }
}

// Do these increments take the part back from where it was pushed?
bool lead_back(const World& world, std::span<const Increment> increments, const KeptPush& push) {
  const Part& part = world.parts[push.part];
  const double radius_mm = part.solid->sphere().radius_mm;
  double along = 0.0;
  for (const Increment& by : increments)
    if (by.part == part.id)
      along += by.translation_mm.dot(push.shift_mm) +
               radius_mm * radius_mm * by.rotation_rad.dot(push.turn_rad);
  return along < 0.0;
}

// Parts that go on with what they were pushed by while they waited, unless somebody else has them
// now or they were put elsewhere. Who pulls back has given up what still waited.
void go_on(const World& world, std::span<const Increment> increments, Scratch::Impl& work,
           StepCounters& counters) {
  for (const KeptPush& push : world.state->kept) {
    const Part& part = world.parts[push.part];
    if (!identical(part.X_WP, push.X_WP) || (part.holder && part.holder != push.user)) continue;
    if (lead_back(world, increments, push)) {
      ++counters.pushes_cut;
      continue;
    }
    Move& move = move_of(work, target_of(world, push.part));
    move.user = push.user;
    move.turned_rad = push.turn_rad.norm();
    Increment rest;
    rest.translation_mm = push.shift_mm;
    rest.rotation_rad = push.turn_rad;
    move.motion.X_W1 = applied(rest, move.motion.X_W1, move.motion.reference_P);
  }
  world.state->kept.clear();
}

// Checks and composes, in order of arrival, on top of what is left of the last tick: motion.X_W1 is
// the target so far.
void compose(World& world, std::span<const Increment> increments, Scratch::Impl& work,
             StepReport& report) {
  StepCounters& counters = report.counters;
  counters.increments.in = increments.size();
  for (const Increment& increment : increments) {
    Refusal refusal = check(world, increment);
    if (refusal == Refusal::kNone) {
      const std::uint32_t index = increment.part.value - 1;
      Move& move = move_of(work, target_of(world, index));
      // The path of a tick turns by the shortest way: more than half a turn in all would go the
      // other way round.
      const double turned_rad = move.turned_rad + increment.rotation_rad.norm();
      const Pose X_W1 = applied(increment, move.motion.X_W1, move.motion.reference_P);
      if (turned_rad > kMaxRotationPerTick_rad) {
        refusal = Refusal::kRotationTooLarge;
      } else if (!within(X_W1.p.cwiseAbs().maxCoeff(), kLongest_mm)) {
        refusal = Refusal::kJumpTooLarge;  // out of the world
      } else {
        move.user = increment.user;
        move.turned_rad = turned_rad;
        move.motion.X_W1 = X_W1;
        world.find(increment.user)->last_seq = increment.seq;
        ++counters.increments.out;
        continue;
      }
    }
    ++counters.refused[static_cast<std::size_t>(refusal)];
    report.refused.push_back({increment.user, increment.part, increment.seq, refusal});
  }
}

// One motion a part; what nobody could feel is no motion.
void make_motions(const World& world, Scratch::Impl& work, StepCounters& counters) {
  counters.moves.in = work.moves.size();
  const std::size_t groups = work.moves.size();
  for (std::size_t i = 0; i < groups; ++i) {
    Move& move = work.moves[i];
    if (world.parts[move.part].group || is_guided(world, move)) {
      spread(world, i, work);
    } else {
      const BoundingSphere& sphere = world.parts[move.part].solid->sphere();
      const Motion motion = linear_motion(move.motion.X_W0, move.motion.X_W1, sphere.center_mm);
      if (motion.moves() && is_felt(motion, sphere.radius_mm))
        move.motion = motion;
      else
        move.motion = still_motion(move.motion.X_W0);
      move.motion.reference_P = sphere.center_mm;
    }
    ++(work.moves[i].motion.moves() ? counters.moves.out : counters.moves_below_rounding);
  }
  for (std::size_t i = groups; i < work.moves.size(); ++i)
    work.move_of_part[work.moves[i].part] = static_cast<std::int32_t>(i);
}

// Parts that were put somewhere have to be looked at as well, and those of a pair that waits.
void add_standing(const World& world, Scratch::Impl& work) {
  for (const std::uint32_t part : world.state->placed) {
    const Part& placed = world.parts[part];
    move_of(work, {part, placed.X_WP, placed.solid->sphere().center_mm}).placed = true;
  }
  for (const IndexPair owed : world.state->owed) {
    const Part& part = world.parts[owed.a];
    move_of(work, {owed.a, part.X_WP, part.solid->sphere().center_mm}).owed = true;
  }
}

// Leaves out what neither moves nor has to be looked at; by part.
void put_in_order(Scratch::Impl& work) {
  for (const Move& move : work.moves) work.move_of_part[move.part] = -1;
  std::erase_if(work.moves, [](const Move& move) {
    return !move.motion.moves() && !move.placed && !move.owed;
  });
  std::sort(work.moves.begin(), work.moves.end(),
            [](const Move& x, const Move& y) { return x.part < y.part; });
  work.moved_parts.clear();
  for (std::size_t i = 0; i < work.moves.size(); ++i) {
    Move& move = work.moves[i];
    MORTISE_CHECK(valid(move.motion) && (i == 0 || work.moves[i - 1].part < move.part),
                  "each part has one valid motion, in the order of the parts");
    move.X_WP_end = move.motion.X_W1;
    move.leg = move.motion;
    work.move_of_part[move.part] = static_cast<std::int32_t>(i);
    work.moved_parts.push_back(move.part);
  }
}

}  // namespace

void gather(World& world, std::span<const Increment> increments, Scratch::Impl& work,
            StepReport& report) {
  if (work.move_of_part.size() != world.parts.size())
    work.move_of_part.assign(world.parts.size(), -1);
  for (const Move& move : work.moves) work.move_of_part[move.part] = -1;
  work.moves.clear();
  go_on(world, increments, work, report.counters);
  compose(world, increments, work, report);
  follow(world, work);
  make_motions(world, work, report.counters);
  add_standing(world, work);
  put_in_order(work);
}

}  // namespace mortise
