#include "common/session/tick/response.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/session/tick/contacts.h"
#include "common/session/tick/depth_budget.h"
#include "common/session/tick/slide.h"
#include "common/session/tick/statistics.h"

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

// The response of one island: what no other island has a part in.
class IslandResponse {
 public:
  IslandResponse(const World& world, Scratch::Impl& work, Island& island, CcdScratch& ccd)
      : world_(world), work_(work), island_(island), ccd_(ccd) {}

  // Finds the time of the next round and who responds then.
  void look_ahead() {
    island_.t = next_time();
    island_.responding.clear();
    if (island_.t < 1.0) find_responding();
  }

  // Those who respond slide on or stop; whoever still moves meets the others where they are then.
  void respond(bool may_slide) {
    island_.to_ask.clear();
    if (island_.t >= 1.0) return;
    island_.changed_at = backed_off(island_.t);
    for (const std::int32_t move : island_.responding) {
      if (may_slide && start_leg(world_, work_, island_, move, island_.changed_at, ccd_)) continue;
      stop(move);
    }
    find_changed();
  }

 private:
  Move& move_at(std::int32_t index) { return work_.moves[static_cast<std::size_t>(index)]; }
  PairWork& pair_at(std::uint32_t index) { return work_.pairs[index]; }

  double next_time() {
    double t = 1.0;
    for (const std::uint32_t i : island_.pairs) {
      const PairWork& pair = pair_at(i);
      if (pair.answer.t_stop < t &&
          (active(work_, pair.ids.move_a) || active(work_, pair.ids.move_b)))
        t = pair.answer.t_stop;
    }
    for (const std::int32_t index : island_.moves) {
      SlidingGroup* sliding = sliding_led_by(index);
      if (!sliding || move_at(index).stopped) continue;
      if (sliding->look_due)
        look_for_release(world_, work_, island_, *sliding, blocked_at(*sliding), ccd_);
      t = std::min(t, sliding->look);
    }
    return t;
  }

  // Null: it does not slide, or another move of its group stands for it.
  SlidingGroup* sliding_led_by(std::int32_t index) {
    const std::int32_t number = move_at(index).sliding;
    if (number < 0) return nullptr;
    SlidingGroup& sliding = work_.sliding[static_cast<std::size_t>(number)];
    return sliding.moves.front() == index ? &sliding : nullptr;
  }

  double blocked_at(const SlidingGroup& sliding) {
    const std::int32_t number = move_at(sliding.moves.front()).sliding;
    double t = 1.0;
    for (const std::uint32_t i : island_.pairs)
      for (const std::int32_t move : {pair_at(i).ids.move_a, pair_at(i).ids.move_b})
        if (move >= 0 && move_at(move).sliding == number) t = std::min(t, pair_at(i).answer.t_stop);
    return t;
  }

  // The last time at which those who respond, or what they may meet, took another path.
  double changed_before() {
    double t = 0.0;
    const auto look = [&](std::int32_t index) {
      if (index < 0) return;
      const Move& move = move_at(index);
      t = std::max(t, move.stopped ? move.stop : move.leg_start);
    };
    for (const std::uint32_t i : island_.pairs) {
      const PairIds& ids = pair_at(i).ids;
      if (!responds(ids.move_a) && !responds(ids.move_b)) continue;
      look(ids.move_a);
      look(ids.move_b);
    }
    return t;
  }

  // A part that is to turn on what it touches must not stand so deep in it as first contact lets
  // it: a slide sets out from a little before, though never from before what happened last.
  double backed_off(double t) {
    if (world_.policy != Policy::kSlide) return t;
    double fastest_mm = 0.0;
    for (const std::int32_t index : island_.responding) {
      const Move& move = move_at(index);
      const double radius_mm = world_.parts[move.part].solid->sphere().radius_mm;
      fastest_mm = std::max(
          fastest_mm, move.leg.travel_upper_bound_mm(radius_mm, 0.0, 1.0) / (1.0 - move.leg_start));
    }
    const bool banded =
        std::any_of(island_.pairs.begin(), island_.pairs.end(), [&](std::uint32_t i) {
          const PairWork& pair = pair_at(i);
          return pair.status.blocks && pair.answer.t_stop == t && !pair.ids.plain();
        });
    const double back_mm = banded ? kBandLift_mm : kBackOff_mm;
    return fastest_mm > 0.0 ? std::max(changed_before(), t - back_mm / fastest_mm) : t;
  }

  // The movers of every pair of that time, one for each body, by index.
  void find_responding() {
    for (const std::uint32_t i : island_.pairs) {
      PairWork& pair = pair_at(i);
      if (pair.answer.t_stop != island_.t ||
          !(active(work_, pair.ids.move_a) || active(work_, pair.ids.move_b)))
        continue;
      pair.status.blocks = true;
      for (const std::int32_t move : {pair.ids.move_a, pair.ids.move_b})
        if (active(work_, move)) add_responding(move);
    }
    for (const std::int32_t index : island_.moves)
      if (const SlidingGroup* sliding = sliding_led_by(index);
          sliding && sliding->look == island_.t && !move_at(index).stopped)
        add_responding(index);
    std::sort(island_.responding.begin(), island_.responding.end());
  }

  bool moves_with(std::int32_t index, std::int32_t other) {
    return index == other || (move_at(index).group && move_at(index).group == move_at(other).group);
  }

  bool responds(std::int32_t index) {
    return index >= 0 && std::any_of(island_.responding.begin(), island_.responding.end(),
                                     [&](std::int32_t other) { return moves_with(index, other); });
  }

  void add_responding(std::int32_t move) {
    if (!responds(move)) island_.responding.push_back(move);
  }

  void stop(std::int32_t index) {
    const double t = island_.changed_at;
    for (const std::int32_t other : island_.moves) {
      Move& move = move_at(other);
      if (!moves_with(index, other) || !move.motion.moves() || move.stopped) continue;
      const double start = move.leg_start;
      move.X_WP_end = move.leg.pose_at((t - start) / (1.0 - start));
      move.stop = t;
      move.stopped = true;
      ++island_.counts.stopped_parts;
    }
  }

  void find_changed() {
    const double t = island_.changed_at;
    for (const std::uint32_t i : island_.pairs) {
      PairWork& pair = pair_at(i);
      if (pair.status.together || pair.ids.placed) continue;
      if (!responds(pair.ids.move_a) && !responds(pair.ids.move_b)) continue;
      if (!active(work_, pair.ids.move_a) && !active(work_, pair.ids.move_b)) continue;
      island_.to_ask.push_back(i);
      remember(pair, t);
      pair.segment.tau = t;
      if (pair.ids.move_a >= 0) pair.segment.motion_a = rest_of(move_at(pair.ids.move_a), t);
      if (pair.ids.move_b >= 0) pair.segment.motion_b = rest_of(move_at(pair.ids.move_b), t);
    }
  }

  void remember(PairWork& pair, double t) {
    if (pair.status.blocks && !pair.status.blocked)
      pair.status.blocked = AskedEarlier{pair.segment, pair.answer, t};
    const double enters = pair.segment.tau + (1.0 - pair.segment.tau) * pair.answer.t_enter;
    if (pair.status.asked && pair.status.near && !pair.status.blocks && enters < t &&
        !pair.status.passed)
      pair.status.passed = AskedEarlier{pair.segment, pair.answer, t};
  }

  const World& world_;
  Scratch::Impl& work_;
  Island& island_;
  CcdScratch& ccd_;
};

// In an island time runs on; the pair that would become real first holds its movers back, everybody
// else goes on, and only the pairs of a part whose path changed have to be asked again. Under stop
// every round stops at least one part, under slide every round costs some body one of its legs:
// there are at most as many rounds as that. Equal times respond together: the order of parts plays
// no role. Islands know nothing of each other, so that their rounds run side by side; only the work
// of the tick is shared among the pairs of all.
class Response {
 public:
  Response(const World& world, Scratch::Impl& work, StepCounters& counters)
      : world_(world), work_(work), counters_(counters) {}

  void run() {
    work_.sliding.clear();
    work_.islands.find(work_.moves, std::span(work_.pairs).first(work_.pair_count),
                       !work_.switches.islands);
    while (true) {
      in_each([](IslandResponse& island) { island.look_ahead(); });
      if (!any_responds()) break;
      ++counters_.rounds;
      const bool may_slide = prepare_slides();
      in_each([may_slide](IslandResponse& island) { island.respond(may_slide); });
      ask_again();
    }
    for (std::size_t i = 0; i < work_.islands.size(); ++i)
      accumulate(counters_, work_.islands[i].counts);
    for (std::size_t i = 0; i < work_.pair_count; ++i) settle(work_.pairs[i]);
  }

 private:
  template <class Body>
  void in_each(const Body& body) {
    work_.pool.for_each(work_.islands.size(), [&](std::size_t i, int thread) {
      IslandResponse island(world_, work_, work_.islands[i],
                            work_.ccd[static_cast<std::size_t>(thread)]);
      body(island);
    });
  }

  bool any_responds() {
    for (std::size_t i = 0; i < work_.islands.size(); ++i)
      if (work_.islands[i].t < 1.0) return true;
    return false;
  }

  // A leg is looked for along what holds the body, which costs as much as a search.
  bool prepare_slides() {
    if (world_.policy != Policy::kSlide) return false;
    const bool may = depth_work_left(work_) > 0 || !work_.switches.work_budget;
    for (std::size_t i = 0; i < work_.islands.size(); ++i) {
      Island& island = work_.islands[i];
      if (!may) island.counts.slides_cut_short += island.responding.size();
      for (const std::int32_t move : island.responding)
        if (may) prepare_leg(world_, work_, move);
    }
    return may;
  }

  void ask_again() {
    work_.to_ask.clear();
    for (std::size_t i = 0; i < work_.islands.size(); ++i) {
      const std::vector<std::uint32_t>& more = work_.islands[i].to_ask;
      work_.to_ask.insert(work_.to_ask.end(), more.begin(), more.end());
    }
    std::sort(work_.to_ask.begin(), work_.to_ask.end());
    ask_pairs(world_, work_, work_.to_ask);
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
};

}  // namespace

void respond(const World& world, Scratch::Impl& work, StepReport& report) {
  if (holds_back(world.policy)) Response(world, work, report.counters).run();
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
