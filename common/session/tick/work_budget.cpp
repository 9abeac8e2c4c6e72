#include "common/session/tick/work_budget.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/session/tick/tick_work.h"

namespace mortise {
namespace {

// An estimate stays within these: fewer are used by any question, more are given to none.
constexpr std::uint64_t kLeastWanted = 100, kMostWanted = 100'000;
// Half a year at 60 Hz. If the count ended sooner, who is served would be the oldest again before
// the others had their turn.
constexpr std::uint32_t kLongestNoted_ticks = 1'000'000'000;

// What each further thread does beside the first, as benchmarked: so many tenths.
constexpr std::int64_t kTenthsOfFurtherThread = 7;

PairMemo::Effort& effort_of(PairWork& pair, WorkStage stage) {
  return pair.ids.memo.change().effort[static_cast<std::size_t>(stage)];
}

}  // namespace

void WorkBudget::open(const WorkRules& rules, const World& world, std::int64_t saved, bool limited,
                      std::int64_t times) {
  const double rate_hz = std::max(1.0, world.tick_rate_hz);
  const std::int64_t of_one =
      std::max(rules.least, static_cast<std::int64_t>(rules.per_second / rate_hz));
  const std::int64_t own = of_one * (10 + kTenthsOfFurtherThread * (world.threads - 1)) / 10;
  own_ = times * own;
  saved_most_ = rules.saved_ticks * own;
  owed_most_ = rules.owed_ticks * own;
  extra_ = static_cast<std::int64_t>(std::ceil(rules.extra_per_second / rate_hz));
  saved_ = saved;
  first_ = world.tick <= 1;
  limited_ = limited && !first_;
}

std::uint64_t WorkBudget::left(std::uint64_t used) const {
  const std::int64_t all = own_ + saved_;
  return less(static_cast<std::uint64_t>(std::max<std::int64_t>(0, all)), used);
}

std::int64_t WorkBudget::close(std::uint64_t used) const {
  if (first_) return saved_most_;
  const std::int64_t unused = own_ - static_cast<std::int64_t>(used);
  const bool saves = unused > 0 && saved_ >= 0;
  const std::int64_t change = saves ? unused / kSavedShare : unused;
  return std::clamp(saved_ + change + extra_, -owed_most_, saved_most_);
}

bool is_held(const World& world, const PairWork& pair) {
  return (pair.ids.move_a >= 0 && world.parts[pair.ids.a].holder) ||
         (pair.ids.move_b >= 0 && world.parts[pair.ids.b].holder);
}

std::uint32_t waited_of(const PairWork& pair, WorkStage stage) {
  return pair.ids.memo->effort[static_cast<std::size_t>(stage)].waited;
}

void in_order(const World& world, std::span<const PairWork> work,
              std::span<const std::uint32_t> pairs, WorkStage stage,
              std::vector<std::uint32_t>& order) {
  order.assign(pairs.begin(), pairs.end());
  const auto rank = [&](std::uint32_t i) {
    const std::int64_t waited = waited_of(work[i], stage);
    const std::int64_t lead = is_held(world, work[i]) ? kHeldLead_ticks : 0;
    return std::tuple(work[i].status.lingers, -waited - lead, i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t x, std::uint32_t y) { return rank(x) < rank(y); });
}

void note_effort(PairWork& pair, WorkStage stage, const UsedWork& work) {
  const std::uint64_t noted = pair.ids.memo->effort[static_cast<std::size_t>(stage)].wanted;
  const std::uint64_t before = noted == 0 ? work.first : noted;
  const std::uint64_t next = work.capped ? std::max(before, 2 * work.cap)
                                         : std::max(work.used + work.used / 2, before - before / 8);
  const auto wanted = static_cast<std::uint32_t>(std::clamp(next, kLeastWanted, kMostWanted));
  if (wanted != noted) effort_of(pair, stage).wanted = wanted;
}

void note_waiting(PairWork& pair, WorkStage stage, bool served) {
  const std::uint32_t before = waited_of(pair, stage);
  if (!served && std::exchange(pair.effort.aged[static_cast<std::size_t>(stage)], true)) return;
  const std::uint32_t waited = served ? 0 : std::min(before + 1, kLongestNoted_ticks);
  if (waited != before) effort_of(pair, stage).waited = waited;
}

}  // namespace mortise
