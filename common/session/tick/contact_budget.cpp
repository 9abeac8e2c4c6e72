#include "common/session/tick/contact_budget.h"

#include <algorithm>

#include "common/session/tick/depth_budget.h"

namespace mortise {
namespace {

// 30,000 tests in a tick of 60 Hz: what one part that slides and turns on a wall may need, and more
// than a tick has time for. Of 40,000 questions of the demo the dearest took 355 under stop and
// 18,000 under slide, where one in a thousand takes more than 6,000.
constexpr WorkRules kRules{
    .per_second = 1'800'000.0, .least = 2'000, .saved_ticks = 2, .owed_ticks = 10};

// What a pair is given that was not asked before: enough for nearly all, and little beside what the
// tick has where it is not.
constexpr std::uint64_t kFirstShare = 2'000;
// The least: a question of a pair that was cheap so far still meets a surprise.
constexpr std::uint64_t kLeastShare = 500;
// So many pairs are asked at least before what was spent is counted again: one for each of two
// cores.
constexpr std::size_t kLeastBatch = 2;

std::uint64_t spent(const Scratch::Impl& work) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < work.pair_count; ++i) sum += work.pairs[i].contact_tests;
  return sum;
}

std::uint64_t share_of(const PairWork& pair) {
  if (pair.contact_short) return kMostContactTests;
  const std::uint32_t wanted =
      pair.memo->effort[static_cast<std::size_t>(WorkStage::kContact)].wanted;
  return wanted == 0 ? kFirstShare
                     : std::clamp<std::uint64_t>(wanted, kLeastShare, kMostContactTests);
}

// Was it cut short, and may it have more?
bool may_go_on(const PairWork& pair) {
  return pair.contact_short && pair.contact_cap < kMostContactTests;
}

}  // namespace

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  const std::int64_t times = world.policy == Policy::kSlide ? kSlideTimes : 1;
  work.contact_budget.open(kRules, world, state.saved_tests, work.switches.work_budget, times);
}

void close_contact_budget(SessionState& state, const Scratch::Impl& work) {
  state.saved_tests = work.contact_budget.close(spent(work));
}

std::size_t share_contact_work(Scratch::Impl& work, std::span<const std::uint32_t> order) {
  const std::uint64_t left = work.contact_budget.left(spent(work));
  if (left == 0) return 0;
  std::uint64_t shared = 0;
  std::size_t count = 0;
  for (; count < order.size(); ++count) {
    PairWork& pair = work.pairs[order[count]];
    pair.contact_cap = share_of(pair);
    pair.contact_start = pair.contact_tests;
    shared += pair.contact_cap;
    if (count >= kLeastBatch && shared > left) break;
  }
  return count;
}

void share_touch_work(Scratch::Impl& work, std::span<const std::uint32_t> pairs) {
  const auto is_unasked = [&](std::uint32_t i) { return work.pairs[i].touch_unasked; };
  const auto count =
      static_cast<std::uint64_t>(std::count_if(pairs.begin(), pairs.end(), is_unasked));
  if (count == 0) return;
  const std::uint64_t each =
      std::clamp(work.contact_budget.left(spent(work)) / count, kFirstShare, kMostContactTests);
  for (const std::uint32_t i : pairs)
    if (is_unasked(i)) work.pairs[i].contact_cap = each;
}

bool note_contact_effort(PairWork& pair) {
  note_effort(pair, WorkStage::kContact,
              {pair.contact_tests - pair.contact_start, pair.contact_cap, pair.contact_short, 0});
  return may_go_on(pair);
}

void note_contact_waiting(PairWork& pair) {
  pair.counts.pairs_waiting += pair.contact_waits ? 1U : 0U;
  note_waiting(pair, WorkStage::kContact, !pair.contact_waits && !may_go_on(pair));
}

}  // namespace mortise
