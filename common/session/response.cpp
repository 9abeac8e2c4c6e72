#include <algorithm>

#include "common/session/tick_work.h"

namespace mortise {
namespace {

bool active(const Scratch::Impl& work, std::int32_t move) {
  if (move < 0) return false;
  const Move& m = work.moves[static_cast<std::size_t>(move)];
  return m.motion.moves() && !m.stopped;
}

// What is left of a move after time t: a linear path cut anywhere is a linear path.
Motion rest_of(const Move& move, double t) {
  const Pose X_Wt = move.motion.pose_at(std::min(t, move.stop));
  Motion rest = still_motion(X_Wt);
  if (!move.stopped && move.motion.moves())
    rest = linear_motion(X_Wt, move.motion.X_W1, move.motion.reference_P);
  rest.reference_P = move.motion.reference_P;
  return rest;
}

}  // namespace

// Policy stop. Time runs on; the pair that would become real first stops its movers, everybody else
// goes on, and only the pairs of a part that was stopped have to be asked again. Every round stops
// at least one part, so there are at most as many rounds as movers. Equal times stop together: the
// order of parts plays no role.
void respond(const World& world, Scratch::Impl& work, StepReport& report) {
  if (world.policy != Policy::kStop) return;
  while (true) {
    // 1. The earliest time at which a pair with a mover has to be stopped.
    double t = 1.0;
    for (std::size_t i = 0; i < work.pair_count; ++i) {
      const PairWork& pair = work.pairs[i];
      if (pair.t_stop < t && (active(work, pair.move_a) || active(work, pair.move_b)))
        t = pair.t_stop;
    }
    if (t >= 1.0) break;
    ++report.counters.rounds;

    // 2. Stop the movers of every pair of that time.
    for (std::size_t i = 0; i < work.pair_count; ++i) {
      PairWork& pair = work.pairs[i];
      if (pair.t_stop == t && (active(work, pair.move_a) || active(work, pair.move_b)))
        pair.blocks = true;
    }
    for (std::size_t i = 0; i < work.pair_count; ++i) {
      if (!work.pairs[i].blocks) continue;
      for (const std::int32_t index : {work.pairs[i].move_a, work.pairs[i].move_b}) {
        if (!active(work, index)) continue;
        Move& move = work.moves[static_cast<std::size_t>(index)];
        move.stop = t;
        move.stopped = true;
        move.X_WP_end = move.motion.pose_at(t);
        ++report.counters.stopped_parts;
      }
    }

    // 3. Whoever still moves meets the stopped parts where they stand now.
    work.again.clear();
    for (std::uint32_t i = 0; i < work.pair_count; ++i) {
      const PairWork& pair = work.pairs[i];
      const auto just_stopped = [&](std::int32_t move) {
        return move >= 0 && work.moves[static_cast<std::size_t>(move)].stopped &&
               work.moves[static_cast<std::size_t>(move)].stop == t;
      };
      if ((just_stopped(pair.move_a) && active(work, pair.move_b)) ||
          (just_stopped(pair.move_b) && active(work, pair.move_a)))
        work.again.push_back(i);
    }
    work.pool.for_each(work.again.size(), [&](std::size_t k, int thread) {
      PairWork& pair = work.pairs[work.again[k]];
      pair.tau = t;
      pair.motion_a = rest_of(work.moves[static_cast<std::size_t>(pair.move_a)], t);
      pair.motion_b = rest_of(work.moves[static_cast<std::size_t>(pair.move_b)], t);
      ask_pair(world, work.switches, pair, work.ccd[static_cast<std::size_t>(thread)]);
    });
  }
}

}  // namespace mortise
