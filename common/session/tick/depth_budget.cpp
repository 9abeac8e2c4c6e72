#include "common/session/tick/depth_budget.h"

#include <algorithm>
#include <array>

#include "common/session/tick/stop_time.h"

namespace mortise {
namespace {

// 5,000 evaluations in a tick of 60 Hz, some 7 ms. More holds up everybody, less leaves more pairs
// waiting. Four ticks' work is saved, so that the first verdict on a clash and a stop at a brink
// are found at once where the session is not always short of work.
constexpr WorkRules kRules{.per_second = 300'000.0,
                           .least = 500,
                           .saved_ticks = 4,
                           .owed_ticks = 2,
                           .extra_per_second = 1'200.0};
// Share of a tick that the search for stops leaves to the verdicts.
constexpr std::uint64_t kVerdictShare = 3;

// By stage: what a tick may have taken of the saved work by its end, and what one pair may have.
// What the search for stops has taken is not there for the verdicts, which may take all that is
// saved. kContact has its own budget.
constexpr std::array<std::uint64_t, 3> kMostOfSaved{0, 2'000, 20'000}, kMostEffort{0, 4'000, 5'000};
// Of what is saved, one pair has no more.
constexpr std::uint64_t kMostOfSavedForOne = 3'500;
// The same where work is not limited.
constexpr std::uint64_t kUnlimitedEffort = 10'000;
// Evaluations of one pair the first time; and the fewest that are of use to a search for the stop:
// parts that leave each other need no more.
constexpr std::uint64_t kFirstEffort = 1'500, kGlance = 250;

// What the times and the motion of an event may take: no less than a first, wide bracket does. So
// much of what is saved is kept for the verdicts of later ticks.
constexpr std::uint64_t kLeastTelling = 200, kMostTelling = 4'000, kKeptForVerdicts = 12'000;

// A search that has come to nothing is not repeated for so many ticks while nothing has changed;
// nor one from the same place for another push, for 2, 4, 8 ... ticks: a short one finds whether
// the parts leave each other.
constexpr std::uint32_t kStalledTicks = 30;
// The pair that is first in the order and has waited so many ticks is served whatever is left: one
// in a tick, so that a tick takes one pair's most work in advance and no more. Without it a pair
// that needs nearly a whole tick's work waits for ever in a session that is always a little short.
constexpr std::uint32_t kLongestWait_ticks = 8;
static_assert(kLongestWait_ticks < kLongestFirst_ticks && kStalledTicks <= kHeldLead_ticks);

std::uint64_t spent(const Scratch::Impl& work) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < work.pair_count; ++i)
    sum += work.pairs[i].effort.counts.depth_evaluations;
  return sum;
}

// What is left of the tick's own work, and of what was saved, from which so much was taken.
struct Left {
  std::uint64_t own = 0, saved = 0, taken_of_saved = 0;
};

Left left_of(const WorkBudget& budget, std::uint64_t used) {
  const std::uint64_t beyond = less(used, budget.own());
  return {less(budget.own(), used), less(budget.saved(), beyond), beyond};
}

std::uint64_t wanted_of(const PairWork& pair, WorkStage stage, std::uint64_t most) {
  const std::uint32_t wanted = pair.ids.memo->effort[static_cast<std::size_t>(stage)].wanted;
  return std::min<std::uint64_t>(wanted == 0 ? kFirstEffort : wanted, most);
}

// Is it known from where it stands that a search for its stop is of little use?
bool rests(const PairWork& pair, std::uint32_t waited) {
  if (waited >= kStalledTicks) return false;
  if (is_stalled(pair) && pair.ids.memo->stalled->in_full) return true;
  const int times = times_in_vain(pair);
  return times > 0 && waited < std::min(kStalledTicks, 1U << std::min(times, 5));
}

// It is given half as much again as it needed the last time, and mostly needs that again.
std::uint64_t expected(std::uint64_t wanted) { return wanted - wanted / 3; }

// One stage of one tick shares out its work, in rounds: what a round did not need is there for the
// next.
class Sharing {
 public:
  Sharing(const World& world, Scratch::Impl& work, WorkStage stage)
      : work_(work), stage_(stage), spent_(spent(work)) {
    const std::uint64_t own = work.depth_budget.own();
    times_ = world.policy == Policy::kSlide ? kSlideTimes : 1;
    for_verdicts_ = stage == WorkStage::kStop ? own / kVerdictShare : 0;
    // No more than there is in some tick, whatever little is asked besides.
    const std::uint64_t own_most =
        stage == WorkStage::kStop ? own - for_verdicts_ : own / kVerdictShare;
    const auto at = static_cast<std::size_t>(stage);
    limited_ = work.depth_budget.is_limited();
    const std::uint64_t saved_most = std::min(kMostOfSaved[at], kMostOfSavedForOne);
    most_ = limited_ ? std::min(times_ * kMostEffort[at], own_most / 2 + times_ * saved_most)
                     : kUnlimitedEffort;
  }

  // Gives work to the first of the order, as many as there is for, and returns how many those are.
  // Where there is none for the first, that one waits, and so do those after it that would want
  // more than the tick has left even if those before them used nothing.
  std::size_t round(std::span<const std::uint32_t> order) {
    left_ = left_now();
    std::uint64_t sum = 0;
    for (const std::uint32_t i : order) sum += expected(wanted_of(work_.pairs[i], stage_, most_));
    // What nobody needs is shared, should somebody need more than it expects.
    more_ = sum > left_.own ? 0 : (left_.own - sum) / order.size();
    const std::uint64_t most_left = left_.own;
    bool all_wait = true;
    const auto has_no_chance = [&](const PairWork& pair) {
      return all_wait && expected(wanted_of(pair, stage_, most_)) > most_left;
    };
    std::size_t count = 0;
    for (; count < order.size(); ++count) {
      PairWork& pair = work_.pairs[order[count]];
      if (!give(pair, count == 0 || has_no_chance(pair))) break;
      all_wait &= kept_for_the_first_;
    }
    return std::max<std::size_t>(count, 1);
  }

  void note_spent(std::span<const std::uint32_t> served) {
    for (const std::uint32_t i : served)
      spent_ += work_.pairs[i].effort.counts.depth_evaluations - work_.pairs[i].effort.stage_start;
  }

 private:
  Left left_now() const {
    Left left = left_of(work_.depth_budget, spent_);
    left.own = less(left.own, for_verdicts_);
    const std::uint64_t most = times_ * kMostOfSaved[static_cast<std::size_t>(stage_)];
    left.saved = std::min(left.saved, less(most, left.taken_of_saved));
    if (kept_for_the_first_) left.saved = 0;
    return left;
  }

  // False: there is no work for it in this round; in the next one it is the first.
  bool give(PairWork& pair, bool is_last_chance) {
    pair.effort.stage_start = pair.effort.counts.depth_evaluations;
    pair.effort.most_work = most_;
    pair.effort.limited = limited_;
    if (!limited_) {
      pair.effort.cap = most_;
      return true;
    }
    const std::uint32_t waited = waited_of(pair, stage_);
    const bool at_rest = stage_ == WorkStage::kStop && rests(pair, waited);
    const std::uint64_t wanted = wanted_of(pair, stage_, most_);
    const bool overdue = !at_rest && is_first_ && waited >= kLongestWait_ticks;
    const bool served = !at_rest && (overdue || expected(wanted) <= left_.own + left_.saved);
    if (!served && !at_rest && !is_last_chance) return false;
    is_first_ &= at_rest;
    if (served)
      serve(pair, overdue ? most_ : std::min(most_, std::max(wanted + more_, surprise())),
            expected(wanted));
    else
      put_off(pair, at_rest);
    note_waiting(pair, stage_, served || pair.status.lingers);
    return true;
  }

  void serve(PairWork& pair, std::uint64_t cap, std::uint64_t taken) {
    pair.effort.cap = cap;
    left_.saved = less(left_.saved, less(taken, left_.own));
    left_.own = less(left_.own, taken);
  }

  // What one pair may need beyond what it did before, as long as the tick has so much.
  std::uint64_t surprise() const { return std::min(left_.own, kFirstEffort); }

  // A verdict that is cut short is discarded, and a push that came to nothing before comes to
  // nothing again; a short search is of use to others.
  void put_off(PairWork& pair, bool at_rest) {
    const bool glances = stage_ == WorkStage::kStop && !is_stalled(pair) && left_.own >= kGlance;
    pair.effort.cap = glances ? kGlance : 0;
    left_.own = less(left_.own, pair.effort.cap);
    if (stage_ == WorkStage::kVerdict && pair.status.lingers) return;
    // What is saved is kept for who has waited longest.
    kept_for_the_first_ |= !at_rest;
    if (kept_for_the_first_) left_.saved = 0;
    ++pair.effort.counts.pairs_waiting;
  }

  Scratch::Impl& work_;
  WorkStage stage_;
  std::uint64_t spent_, times_ = 1, for_verdicts_ = 0;
  Left left_;
  bool limited_ = true;
  bool is_first_ = true;  // of those that do not rest
  bool kept_for_the_first_ = false;
  std::uint64_t most_ = 0, more_ = 0;
};

}  // namespace

void open_depth_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  const std::int64_t times = world.policy == Policy::kSlide ? kSlideTimes : 1;
  work.depth_budget.open(kRules, world, state.saved_work, work.switches.work_budget, times);
}

void close_depth_budget(SessionState& state, const Scratch::Impl& work) {
  state.saved_work = work.depth_budget.close(spent(work));
}

std::uint64_t depth_work_left(const Scratch::Impl& work) {
  const Left left = left_of(work.depth_budget, spent(work));
  return left.own + left.saved;
}

void serve_in_turn(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
                   WorkStage stage, const ServePair& serve) {
  in_order(world, std::span(work.pairs).first(work.pair_count), pairs, stage, work.order);
  Sharing sharing(world, work, stage);
  for (std::span<const std::uint32_t> order = work.order; !order.empty();) {
    const auto served = order.first(sharing.round(order));
    work.pool.for_each(served.size(), [&](std::size_t i, int thread) {
      serve(work.pairs[served[i]], work.ccd[static_cast<std::size_t>(thread)]);
    });
    sharing.note_spent(served);
    order = order.subspan(served.size());
  }
}

void share_telling_work(Scratch::Impl& work, std::span<const std::uint32_t> pairs) {
  if (pairs.empty()) return;
  const bool limited = work.depth_budget.is_limited();
  const Left left = left_of(work.depth_budget, spent(work));
  const std::uint64_t for_telling = left.own + less(left.saved, kKeptForVerdicts);
  const std::uint64_t each =
      limited ? std::clamp(for_telling / pairs.size(), kLeastTelling, kMostTelling)
              : kUnlimitedEffort;
  for (const std::uint32_t i : pairs) {
    PairWork& pair = work.pairs[i];
    pair.effort.stage_start = pair.effort.counts.depth_evaluations;
    pair.effort.cap = pair.effort.most_work = each;
    pair.effort.limited = limited;
  }
}

void note_depth_effort(PairWork& pair, WorkStage stage, bool capped) {
  note_effort(pair, stage,
              {pair.effort.counts.depth_evaluations - pair.effort.stage_start, pair.effort.cap,
               capped, kFirstEffort});
}

}  // namespace mortise
