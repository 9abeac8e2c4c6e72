#include "common/session/tick/contact_budget.h"

#include <algorithm>

#include "common/base/constants.h"
#include "common/session/tick/work_budget.h"

namespace mortise {
namespace {

// 30,000 tests in a tick of 60 Hz: what one part that slides and turns on a wall may need, and more
// than a tick has time for. Of 40,000 questions of the demo the dearest took 355 under stop and
// 18,000 under slide, where one in a thousand takes more than 6,000.
constexpr double kTestsPerSecond = 1'800'000.0;
constexpr std::int64_t kLeastTests = 2'000;
// What a tick does not need is saved in part, up to so many ticks' worth; so many are owed at most.
constexpr std::int64_t kSavedShare = 4, kMostSavedTicks = 2, kMostOwedTicks = 10;

// First share of a pair: fewer are of little use, more are taken from those that come after.
constexpr std::uint64_t kLeastShare = 100, kMostShare = 500;
// The most of one pair, some 50 ms and more: where that does not do it is left where it is clear.
constexpr std::uint64_t kMostTests = 50'000;

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

std::int64_t own_tests(const World& world) {
  const double rate_hz = std::max(1.0, world.tick_rate_hz);
  const std::int64_t own =
      std::max(kLeastTests, static_cast<std::int64_t>(kTestsPerSecond / rate_hz));
  return world.policy == Policy::kSlide ? static_cast<std::int64_t>(kSlideTimes) * own : own;
}

std::uint64_t spent(const Scratch::Impl& work) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < work.pair_count; ++i) sum += work.pairs[i].contact_tests;
  return sum;
}

}  // namespace

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  // How a session begins is judged in one go, before anybody waits for it.
  const bool unlimited = world.tick <= 1 || !work.switches.work_budget;
  work.contact_budget = unlimited ? kNoLimit
                                  : static_cast<std::uint64_t>(std::max<std::int64_t>(
                                        0, own_tests(world) + state.saved_tests));
}

void close_contact_budget(const World& world, SessionState& state, const Scratch::Impl& work) {
  const std::int64_t own = own_tests(world), most = kMostSavedTicks * own;
  if (world.tick <= 1) {
    state.saved_tests = most;
    return;
  }
  const std::int64_t used = static_cast<std::int64_t>(spent(work));
  // What is owed is paid back in full before anything is saved.
  const bool saves = used < own && state.saved_tests >= 0;
  const std::int64_t change = saves ? (own - used) / kSavedShare : own - used;
  state.saved_tests = std::clamp(state.saved_tests + change, -kMostOwedTicks * own, most);
}

bool is_contact_unlimited(const Scratch::Impl& work) { return work.contact_budget == kNoLimit; }

std::vector<std::uint32_t> contact_order(const World& world, const Scratch::Impl& work,
                                         std::span<const std::uint32_t> pairs) {
  std::vector<std::uint32_t> order(pairs.begin(), pairs.end());
  if (order.empty()) return order;
  const auto first = static_cast<std::ptrdiff_t>(world.tick * kContactBatch % order.size());
  std::rotate(order.begin(), order.begin() + first, order.end());
  std::stable_partition(order.begin(), order.end(),
                        [&](std::uint32_t i) { return is_held(world, work.pairs[i]); });
  return order;
}

void share_contact_work(const World& world, Scratch::Impl& work,
                        std::span<const std::uint32_t> batch) {
  const std::uint64_t left = less(static_cast<std::uint64_t>(own_tests(world)), spent(work));
  const std::uint64_t share =
      left == 0 ? 0 : std::clamp(left / batch.size(), kLeastShare, kMostShare);
  for (const std::uint32_t i : batch) work.pairs[i].contact_cap = share;
}

bool share_more_contact_work(Scratch::Impl& work, std::span<const std::uint32_t> batch) {
  if (spent(work) >= work.contact_budget) return false;
  for (const std::uint32_t i : batch) work.pairs[i].contact_cap = kMostTests;
  return true;
}

}  // namespace mortise
