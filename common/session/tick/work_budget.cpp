#include "common/session/tick/work_budget.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "common/session/tick/stop_time.h"

namespace mortise {
namespace {

// Evaluations a second: 3,000 in a tick of 60 Hz, some 7 ms. More holds up everybody, less leaves
// more pairs waiting: with 2,000 the demo loses the press fit of its bearing.
constexpr double kWorkPerSecond = 180'000.0;
constexpr std::uint64_t kLeastTickWork = 500;
// Share of a tick that the search for stops leaves to the verdicts.
constexpr std::uint64_t kVerdictShare = 3;

// What is saved at most, so that the first verdict on a clash and a stop at a brink are found at
// once where the session is not always short of work; what may be overdrawn at most; and what is
// set aside a second in a session that is, so that the dearest pair has its turn some time.
constexpr std::int64_t kMostSaved = 12'000, kMostOverdrawn = 4'000;
constexpr double kSetAsidePerSecond = 1'200.0;
// Of what a tick does not need so much is saved: less leaves more pairs waiting in a session that
// is seldom short, more makes for more long ticks in one that often is.
constexpr std::int64_t kSavedShare = 4;

// By stage: what a tick may have taken of that by its end, and what one pair may have. What the
// search for stops has taken is not there for the verdicts.
constexpr std::array<std::uint64_t, 2> kMostOfSaved{2'000, 3'500}, kMostEffort{4'000, 5'000};
// The same where work is not limited.
constexpr std::uint64_t kUnlimitedEffort = 10'000;
// Evaluations of one pair the first time; and the fewest that are of use to a search for the stop:
// parts that leave each other need no more.
constexpr std::uint64_t kFirstEffort = 1'500, kGlance = 250;

// A search that has come to nothing is not repeated for so many ticks while nothing has changed;
// nor one from the same place for another push, for 2, 4, 8 ... ticks: a short one finds whether
// the parts leave each other.
constexpr std::uint8_t kStalledTicks = 30;

// So many ticks who is not held waits behind who is; and who has waited so many for a verdict is
// judged before anybody else, whatever is left, one in a tick.
constexpr int kHeldLead_ticks = 30;
constexpr std::uint8_t kLongestWait_ticks = 45;

constexpr std::uint64_t kNoLimit = 1'000'000'000;

std::uint64_t own_work(const World& world) {
  const std::uint64_t own =
      std::max(kLeastTickWork,
               static_cast<std::uint64_t>(kWorkPerSecond / std::max(1.0, world.tick_rate_hz)));
  return world.policy == Policy::kSlide ? kSlideTimes * own : own;
}

std::uint64_t spent(const Scratch::Impl& work) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < work.pair_count; ++i) sum += work.pairs[i].counts.depth_evaluations;
  return sum;
}

// What is left of the tick's own work, and of what was saved, from which so much was taken.
struct Left {
  std::uint64_t own = 0, saved = 0, taken_of_saved = 0;
};

Left left_of(const Scratch::Impl& work) {
  const std::uint64_t used = spent(work), beyond = less(used, work.budget);
  return {less(work.budget, used), less(work.stock, beyond), beyond};
}

// Pairs in the order in which they are served.
std::vector<std::uint32_t> in_order(const World& world, const Scratch::Impl& work,
                                    std::span<const std::uint32_t> pairs, std::size_t stage) {
  std::vector<std::uint32_t> order(pairs.begin(), pairs.end());
  const auto rank = [&](std::uint32_t i) {
    const PairWork& pair = work.pairs[i];
    const int waited = pair.memo->effort[stage].waited;
    return std::tuple(-waited - (is_held(world, pair) ? kHeldLead_ticks : 0), i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t x, std::uint32_t y) { return rank(x) < rank(y); });
  return order;
}

std::uint64_t wanted_of(const PairWork& pair, std::size_t stage, std::uint64_t most) {
  const std::uint32_t wanted = pair.memo->effort[stage].wanted;
  return std::min<std::uint64_t>(wanted == 0 ? kFirstEffort : wanted, most);
}

// Is it known from where it stands that a search is of little use?
bool is_in_vain(const PairWork& pair, std::uint8_t waited) {
  const int times = times_in_vain(pair);
  return times > 0 && waited < std::min<int>(kStalledTicks, 1 << std::min(times, 5));
}

// It is given half as much again as it needed the last time, and mostly needs that again.
std::uint64_t expected(std::uint64_t wanted) { return wanted - wanted / 3; }

}  // namespace

bool is_held(const World& world, const PairWork& pair) {
  return (pair.move_a >= 0 && world.parts[pair.a].holder) ||
         (pair.move_b >= 0 && world.parts[pair.b].holder);
}

void open_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  // How a session begins is judged in one go, before anybody waits for it.
  const bool first = world.tick <= 1;
  work.budget = first ? kNoLimit : own_work(world);
  work.stock = static_cast<std::uint64_t>(std::max<std::int64_t>(0, state.saved_work));
}

void close_budget(const World& world, SessionState& state, const Scratch::Impl& work) {
  if (world.tick <= 1) {
    state.saved_work = kMostSaved;
    return;
  }
  const auto own = static_cast<std::int64_t>(own_work(world));
  const auto used = static_cast<std::int64_t>(spent(work));
  const auto aside =
      static_cast<std::int64_t>(kSetAsidePerSecond / std::max(1.0, world.tick_rate_hz)) + 1;
  const std::int64_t change = used < own ? (own - used) / kSavedShare : own - used;
  state.saved_work = std::clamp(state.saved_work + change + aside, -kMostOverdrawn, kMostSaved);
}

std::uint64_t work_left(const Scratch::Impl& work) {
  const Left left = left_of(work);
  return left.own + left.saved;
}

void share_out(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
               WorkStage stage) {
  const auto at = static_cast<std::size_t>(stage);
  const std::uint64_t for_verdicts = own_work(world) / kVerdictShare;
  Left left = left_of(work);
  if (stage == WorkStage::kStop) left.own = less(left.own, for_verdicts);
  const std::uint64_t times = world.policy == Policy::kSlide ? kSlideTimes : 1;
  left.saved = std::min(left.saved, less(times * kMostOfSaved[at], left.taken_of_saved));
  // No more than there is in some tick, whatever little is asked besides.
  const std::uint64_t own_most =
      stage == WorkStage::kStop ? own_work(world) - for_verdicts : for_verdicts;
  const bool limited = work.switches.work_budget && work.budget < kNoLimit;
  const std::uint64_t most =
      limited ? std::min(times * kMostEffort[at], own_most / 2 + times * kMostOfSaved[at])
              : kUnlimitedEffort;
  const std::vector<std::uint32_t> order = in_order(world, work, pairs, at);
  std::uint64_t sum = 0;
  for (const std::uint32_t i : order) sum += expected(wanted_of(work.pairs[i], at, most));
  // What nobody needs is shared, should somebody need more than it expects.
  const std::uint64_t more = order.empty() || sum > left.own ? 0 : (left.own - sum) / order.size();
  for (const std::uint32_t i : order) {
    PairWork& pair = work.pairs[i];
    PairMemo::Effort& effort = pair.memo.change().effort[at];
    pair.stage_start = pair.counts.depth_evaluations;
    pair.most_work = most;
    pair.limited = limited;
    if (!limited) {
      pair.cap = most;
      continue;
    }
    const std::uint64_t wanted = wanted_of(pair, at, most);
    const bool stalled = stage == WorkStage::kStop && is_stalled(pair);
    const bool rests = stage == WorkStage::kStop &&
                       ((stalled && pair.memo->stalled->in_full && effort.waited < kStalledTicks) ||
                        is_in_vain(pair, effort.waited));
    const bool overdue =
        stage == WorkStage::kVerdict && i == order.front() && effort.waited >= kLongestWait_ticks;
    const bool served = !rests && (overdue || expected(wanted) <= left.own + left.saved);
    std::uint64_t taken = expected(wanted);
    if (served) {
      // Who has waited that long is not put off again for having asked too little.
      pair.cap = overdue ? most : std::min(most, wanted + more);
      left.saved = less(left.saved, less(taken, left.own));
    } else {
      // Half a verdict is worth nothing, and so is a push that came to nothing before.
      const bool glances = stage == WorkStage::kStop && !stalled && left.own >= kGlance;
      taken = pair.cap = glances ? kGlance : 0;
      // What is saved is kept for who has waited longest.
      if (!rests) left.saved = 0;
      ++pair.counts.pairs_waiting;
    }
    effort.waited = served ? 0 : static_cast<std::uint8_t>(std::min(effort.waited + 1, 250));
    left.own = less(left.own, taken);
  }
}

void note_effort(PairWork& pair, WorkStage stage, bool capped) {
  PairMemo::Effort& effort = pair.memo.change().effort[static_cast<std::size_t>(stage)];
  const std::uint64_t used = pair.counts.depth_evaluations - pair.stage_start;
  const std::uint64_t before = effort.wanted == 0 ? kFirstEffort : effort.wanted;
  // Who was given less than it wanted has learned nothing of what it needs.
  // And an easy tick does not say that the next one is.
  const std::uint64_t next =
      capped ? std::max(before, 2 * pair.cap) : std::max(used + used / 2, before - before / 8);
  effort.wanted = static_cast<std::uint32_t>(std::clamp(next, kGlance, kUnlimitedEffort));
}

}  // namespace mortise
