#include "common/session/tick/response.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/session/tick/contacts.h"
#include "common/session/tick/depth_budget.h"
#include "common/session/tick/slide.h"

namespace mortise {
namespace {

// How far a slide sets out before the place where something holds it, mm.
constexpr double kBackOff_mm = 4.0 * kAccuracyDefault_mm;

bool active(const Scratch::Impl& work, std::int32_t move) {
  if (move < 0) return false;
  const Move& m = work.moves[static_cast<std::size_t>(move)];
  return m.motion.moves() && !m.stopped;
}

// What is left of a move after time t: a linear path cut anywhere is a linear path.
Motion rest_of(const Move& move, double t) {
  const double start = move.leg_start;
  const double from = (std::min(t, move.stop) - start) / (1.0 - start);
  const Pose X_Wt = move.leg.pose_at(from);
  Motion rest = still_motion(X_Wt);
  if (!move.stopped && move.leg.moves()) {
    if (from == 0.0) return move.leg;
    rest = linear_motion(X_Wt, move.leg.X_W1, move.leg.reference_P);
    if (move.group && rest.moves()) {  // what moves as one keeps its velocities to the last bit
      rest.v_W = (1.0 - from) * move.leg.v_W;
      rest.w_W = (1.0 - from) * move.leg.w_W;
      rest.axis_W = move.leg.axis_W + from * move.leg.v_W;
    }
  }
  rest.reference_P = move.leg.reference_P;
  return rest;
}

// Judged is what was asked then.
void take_back(PairWork& pair, const AskedEarlier& asked) {
  pair.status.asked = pair.status.near = true;
  pair.status.touching = false;
  pair.segment = asked.segment;
  pair.answer = asked.answer;
}

class Response {
 public:
  Response(const World& world, Scratch::Impl& work, StepReport& report)
      : world_(world), work_(work), counters_(report.counters) {}

  // Time runs on; the pair that would become real first holds its movers back, everybody else goes
  // on, and only the pairs of a part whose path changed have to be asked again. Under stop every
  // round stops at least one part, under slide every round costs some body one of its legs: there
  // are at most as many rounds as that. Equal times respond together: the order of parts plays no
  // role.
  void run() {
    work_.sliding.clear();
    while (true) {
      const double t = next_time();
      if (t >= 1.0) break;
      ++counters_.rounds;
      find_responding(t);
      changed_at_ = backed_off(t);
      for (const std::int32_t move : responding_) respond(move, changed_at_);
      ask_again(changed_at_);
    }
    for (std::size_t i = 0; i < work_.pair_count; ++i) settle(work_.pairs[i]);
  }

 private:
  Move& move_at(std::int32_t index) { return work_.moves[static_cast<std::size_t>(index)]; }

  double next_time() {
    double t = 1.0;
    for (std::size_t i = 0; i < work_.pair_count; ++i) {
      const PairWork& pair = work_.pairs[i];
      if (pair.answer.t_stop < t &&
          (active(work_, pair.ids.move_a) || active(work_, pair.ids.move_b)))
        t = pair.answer.t_stop;
    }
    for (SlidingGroup& sliding : work_.sliding) {
      if (move_at(sliding.moves.front()).stopped) continue;
      if (sliding.look_due) look_for_release(world_, work_, sliding, blocked_at(sliding));
      t = std::min(t, sliding.look);
    }
    return t;
  }

  double blocked_at(const SlidingGroup& sliding) {
    const std::int32_t number = move_at(sliding.moves.front()).sliding;
    double t = 1.0;
    for (std::size_t i = 0; i < work_.pair_count; ++i)
      for (const std::int32_t move : {work_.pairs[i].ids.move_a, work_.pairs[i].ids.move_b})
        if (move >= 0 && move_at(move).sliding == number)
          t = std::min(t, work_.pairs[i].answer.t_stop);
    return t;
  }

  // A part that is to turn on what it touches must not stand so deep in it as first contact lets
  // it: a slide sets out from a little before, though never from before what happened last.
  double backed_off(double t) {
    if (world_.policy != Policy::kSlide) return t;
    double fastest_mm = 0.0;
    for (const std::int32_t index : responding_) {
      const Move& move = move_at(index);
      const double radius_mm = world_.parts[move.part].solid->sphere().radius_mm;
      fastest_mm = std::max(
          fastest_mm, move.leg.travel_upper_bound_mm(radius_mm, 0.0, 1.0) / (1.0 - move.leg_start));
    }
    const bool banded = std::any_of(
        work_.pairs.begin(), work_.pairs.begin() + static_cast<std::ptrdiff_t>(work_.pair_count),
        [&](const PairWork& pair) {
          return pair.status.blocks && pair.answer.t_stop == t && !pair.ids.plain();
        });
    const double back_mm = banded ? kBandLift_mm : kBackOff_mm;
    return fastest_mm > 0.0 ? std::max(changed_at_, t - back_mm / fastest_mm) : t;
  }

  // The movers of every pair of that time, one for each body, by index.
  void find_responding(double t) {
    responding_.clear();
    for (std::size_t i = 0; i < work_.pair_count; ++i) {
      PairWork& pair = work_.pairs[i];
      if (pair.answer.t_stop != t ||
          !(active(work_, pair.ids.move_a) || active(work_, pair.ids.move_b)))
        continue;
      pair.status.blocks = true;
      for (const std::int32_t move : {pair.ids.move_a, pair.ids.move_b})
        if (active(work_, move)) add_responding(move);
    }
    for (const SlidingGroup& sliding : work_.sliding)
      if (sliding.look == t && !move_at(sliding.moves.front()).stopped)
        add_responding(sliding.moves.front());
    std::sort(responding_.begin(), responding_.end());
  }

  void add_responding(std::int32_t move) {
    const bool known = std::any_of(responding_.begin(), responding_.end(), [&](std::int32_t other) {
      return other == move || (move_at(move).group && move_at(move).group == move_at(other).group);
    });
    if (!known) responding_.push_back(move);
  }

  // A leg is looked for along what holds the body, which costs as much as a search.
  bool may_slide() {
    if (world_.policy != Policy::kSlide) return false;
    if (depth_work_left(work_) > 0 || !work_.switches.work_budget) return true;
    ++counters_.slides_cut_short;
    return false;
  }

  void respond(std::int32_t index, double t) {
    if (may_slide() && start_leg(world_, work_, index, t, counters_)) return;
    for (Move& move : work_.moves) {
      if (&move != &move_at(index) && !(move.group && move.group == move_at(index).group)) continue;
      if (!move.motion.moves() || move.stopped) continue;
      const double start = move.leg_start;
      move.X_WP_end = move.leg.pose_at((t - start) / (1.0 - start));
      move.stop = t;
      move.stopped = true;
      ++counters_.stopped_parts;
    }
  }

  // Whoever still moves meets the others where they are now.
  void ask_again(double t) {
    work_.to_ask.clear();
    const auto changed = [&](std::int32_t index) {
      if (index < 0) return false;
      const Move& move = move_at(index);
      return move.stopped ? move.stop == t : move.sliding >= 0 && move.leg_start == t;
    };
    for (std::uint32_t i = 0; i < work_.pair_count; ++i) {
      const PairWork& pair = work_.pairs[i];
      if (pair.status.together || pair.ids.placed) continue;
      if (!changed(pair.ids.move_a) && !changed(pair.ids.move_b)) continue;
      if (active(work_, pair.ids.move_a) || active(work_, pair.ids.move_b))
        work_.to_ask.push_back(i);
    }
    for (const std::uint32_t i : work_.to_ask) {
      PairWork& pair = work_.pairs[i];
      remember(pair, t);
      pair.segment.tau = t;
      if (pair.ids.move_a >= 0) pair.segment.motion_a = rest_of(move_at(pair.ids.move_a), t);
      if (pair.ids.move_b >= 0) pair.segment.motion_b = rest_of(move_at(pair.ids.move_b), t);
    }
    ask_pairs(world_, work_, work_.to_ask);
  }

  void remember(PairWork& pair, double t) {
    if (pair.status.blocks && !pair.status.blocked)
      pair.status.blocked = AskedEarlier{pair.segment, pair.answer, t};
    const double enters = pair.segment.tau + (1.0 - pair.segment.tau) * pair.answer.t_enter;
    if (pair.status.asked && pair.status.near && !pair.status.blocks && enters < t &&
        !pair.status.passed)
      pair.status.passed = AskedEarlier{pair.segment, pair.answer, t};
  }

  // A pair that held somebody back is judged as it was then; one that was near and left again is
  // told as passing.
  void settle(PairWork& pair) {
    if (pair.status.blocked) {
      take_back(pair, *pair.status.blocked);
      pair.status.blocks = true;
    } else if (pair.status.passed && !(pair.status.asked && pair.status.near)) {
      take_back(pair, *pair.status.passed);
      pair.status.t_left = pair.status.passed->t_end;
    }
  }

  const World& world_;
  Scratch::Impl& work_;
  StepCounters& counters_;
  std::vector<std::int32_t> responding_;
  double changed_at_ = 0.0;  ///< time of the last round
};

}  // namespace

void respond(const World& world, Scratch::Impl& work, StepReport& report) {
  if (holds_back(world.policy)) Response(world, work, report).run();
}

void note_held(const World& world, Scratch::Impl& work) {
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    PairWork& pair = work.pairs[i];
    if (!pair.status.blocks || !pair.answer.place.known() ||
        std::isfinite(pair.ids.memo->allowed_depth_mm))
      continue;
    pair.ids.memo.change().held =
        PairMemo::Held{world.parts[pair.ids.a].X_WP, world.parts[pair.ids.b].X_WP,
                       pair.answer.place, pair.answer.stop_gave_up};
  }
}

}  // namespace mortise
