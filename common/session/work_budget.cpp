#include "common/session/work_budget.h"

#include <algorithm>
#include <tuple>

namespace mortise {
namespace {

// Evaluations a second: 2,000 in a tick of 60 Hz, some 6 ms. More holds up everybody, less leaves
// more pairs waiting.
constexpr double kWorkPerSecond = 120'000.0;
constexpr std::uint64_t kLeastTickWork = 500;
// What quiet ticks save, and the time in which they do. With a tick's own it stays below two ticks
// of 60 Hz, and comes in fewer than one of two hundred ticks of a session that always needs more.
constexpr std::uint64_t kMostSaved = 6'000;
constexpr double kSavedIn_s = 4.0;

// Evaluations of one pair in a stage: the first time, the fewest that are of use (parts that leave
// each other need no more), and the most.
constexpr std::uint64_t kFirstEffort = 1'500, kLeastEffort = 250, kMostEffort = 10'000;

constexpr std::uint64_t kNoLimit = 1'000'000'000;

// A leg of a slide is searched like a push of its own, and several of them in a tick.
constexpr std::uint64_t kSlideTimes = 2;

// Share of a tick that the search for stops leaves to the verdicts.
constexpr std::uint64_t kVerdictShare = 3;

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

bool is_held(const World& world, const PairWork& pair) {
  return (pair.move_a >= 0 && world.parts[pair.a].holder) ||
         (pair.move_b >= 0 && world.parts[pair.b].holder);
}

}  // namespace

void open_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  // How a session begins is judged in one go, before anybody waits for it.
  const bool first = world.tick <= 1;
  work.budget = first ? kNoLimit : own_work(world) + std::min(state.saved_work, kMostSaved);
}

void close_budget(const World& world, SessionState& state, const Scratch::Impl& work) {
  const std::uint64_t own = own_work(world);
  const std::uint64_t used = spent(work);
  const std::uint64_t beyond = used > own ? used - own : 0;
  const auto gained = static_cast<std::uint64_t>(static_cast<double>(kMostSaved) /
                                                 (kSavedIn_s * std::max(1.0, world.tick_rate_hz)));
  const std::uint64_t saved = std::min(state.saved_work, kMostSaved);
  state.saved_work = std::min(kMostSaved, saved - std::min(saved, beyond) + gained + 1);
}

std::uint64_t work_left(const Scratch::Impl& work) {
  const std::uint64_t used = spent(work);
  return used < work.budget ? work.budget - used : 0;
}

void share_out(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
               WorkStage stage) {
  const auto at = static_cast<std::size_t>(stage);
  std::vector<std::uint32_t> order(pairs.begin(), pairs.end());
  const auto rank = [&](std::uint32_t i) {
    const PairWork& pair = work.pairs[i];
    return std::tuple(!is_held(world, pair), -static_cast<int>(pair.memo->effort[at].waited), i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t x, std::uint32_t y) { return rank(x) < rank(y); });
  std::uint64_t left = work_left(work);
  if (stage == WorkStage::kStop) left -= std::min(left, own_work(world) / kVerdictShare);
  std::uint64_t unserved = order.size();
  for (const std::uint32_t i : order) {
    PairWork& pair = work.pairs[i];
    PairMemo::Effort& effort = pair.memo->effort[at];
    const std::uint64_t wanted =
        effort.wanted == 0 ? kFirstEffort
                           : std::clamp<std::uint64_t>(effort.wanted, kLeastEffort, kMostEffort);
    pair.stage_start = pair.counts.depth_evaluations;
    const bool first = i == order.front() && left >= kLeastEffort;
    const std::uint64_t share = left / unserved--;
    if (!work.switches.work_budget) {
      pair.cap = kMostEffort;
    } else if (wanted <= left || first) {
      pair.cap = std::min({kMostEffort, std::max(wanted, share), left});
    } else {
      pair.cap = left >= kLeastEffort ? kLeastEffort : 0;
    }
    const bool waits = pair.cap < wanted && !first;
    effort.waited = waits ? static_cast<std::uint8_t>(std::min(effort.waited + 1, 250)) : 0;
    left -= std::min(left, pair.cap);
    if (pair.cap == 0) ++pair.counts.pairs_waiting;
  }
}

bool may_have_more(const PairWork& pair, WorkStage stage) {
  const std::uint32_t wanted = pair.memo->effort[static_cast<std::size_t>(stage)].wanted;
  return wanted < kMostEffort;
}

void note_effort(PairWork& pair, WorkStage stage, bool capped) {
  PairMemo::Effort& effort = pair.memo->effort[static_cast<std::size_t>(stage)];
  const std::uint64_t used = pair.counts.depth_evaluations - pair.stage_start;
  const std::uint64_t before = effort.wanted == 0 ? kFirstEffort : effort.wanted;
  const std::uint64_t next = capped ? 2 * std::max(pair.cap, before) : 2 * used;
  effort.wanted = static_cast<std::uint32_t>(std::clamp(next, kLeastEffort, kMostEffort));
}

}  // namespace mortise
