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
  for (std::size_t i = 0; i < work.pair_count; ++i) sum += work.pairs[i].effort.contact_tests;
  return sum;
}

std::uint64_t share_of(const PairWork& pair) {
  if (pair.effort.contact_short) return kMostContactTests;
  const std::uint32_t wanted =
      pair.ids.memo->effort[static_cast<std::size_t>(WorkStage::kContact)].wanted;
  return wanted == 0 ? kFirstShare
                     : std::clamp<std::uint64_t>(wanted, kLeastShare, kMostContactTests);
}

// Was it cut short, and may it have more?
bool may_go_on(const PairWork& pair) {
  return pair.effort.contact_short && pair.effort.contact_cap < kMostContactTests;
}

void begin(PairWork& pair, std::uint64_t cap) {
  pair.effort.contact_cap = cap;
  pair.effort.contact_short = false;
  pair.effort.clear_of_band = pair.effort.clear_of_touch = 0.0;
}

// Has it waited so long that it is asked whatever is left, if it is the first?
bool is_due(const PairWork& pair) {
  const std::uint32_t waited = waited_of(pair, WorkStage::kContact);
  return waited > 0 && waited % kLongestFirst_ticks == 0;
}

// Sets PairWork::contact_cap of the first of these pairs and returns how many are asked next, at
// once: as many as the tick has work for, at least two. 0: the tick has no work left.
std::size_t share(Scratch::Impl& work, std::span<const std::uint32_t> order, bool first_is_due) {
  const std::uint64_t left = work.contact_budget.left(spent(work));
  if (order.empty() || (left == 0 && !first_is_due)) return 0;
  std::uint64_t shared = 0;
  std::size_t count = 0;
  for (; count < order.size(); ++count) {
    PairWork& pair = work.pairs[order[count]];
    pair.effort.contact_cap = first_is_due && count == 0 ? kMostContactTests : share_of(pair);
    pair.effort.contact_start = pair.effort.contact_tests;
    shared += pair.effort.contact_cap;
    if (left == 0) return 1;
    if (count >= kLeastBatch && shared > left) break;
  }
  return count;
}

void ask_each(Scratch::Impl& work, std::span<const std::uint32_t> pairs, const AskPair& ask) {
  work.pool.for_each(pairs.size(), [&](std::size_t i, int thread) {
    ask(work.pairs[pairs[i]], work.ccd[static_cast<std::size_t>(thread)]);
  });
}

// Asks pairs as long as the tick has work; those that could go on are added to `again`. Returns the
// pairs for which there was none.
std::span<const std::uint32_t> ask_while_it_lasts(Scratch::Impl& work,
                                                  std::span<const std::uint32_t> order,
                                                  bool first_is_due, const AskPair& ask,
                                                  std::vector<std::uint32_t>& again) {
  while (const std::size_t count = share(work, order, first_is_due)) {
    first_is_due = false;
    const auto batch = order.first(count);
    order = order.subspan(count);
    ask_each(work, batch, ask);
    for (const std::uint32_t i : batch) {
      PairWork& pair = work.pairs[i];
      note_effort(pair, WorkStage::kContact,
                  {pair.effort.contact_tests - pair.effort.contact_start, pair.effort.contact_cap,
                   pair.effort.contact_short, 0});
      if (may_go_on(pair)) again.push_back(i);
    }
  }
  return order;
}

}  // namespace

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work) {
  const std::int64_t times = world.policy == Policy::kSlide ? kSlideTimes : 1;
  work.contact_budget.open(kRules, world, state.saved_tests, work.switches.work_budget, times);
}

void close_contact_budget(SessionState& state, const Scratch::Impl& work) {
  state.saved_tests = work.contact_budget.close(spent(work));
}

// 1. as many of the earliest in the order as the tick has work for, each with its share.
// 2. whose share did not do goes on with all that a pair may have, as long as there is work.
void ask_in_turn(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
                 const AskPair& ask) {
  const bool limited = work.contact_budget.is_limited();
  for (const std::uint32_t i : pairs) begin(work.pairs[i], limited ? 0 : kCcdWorkCap);
  if (!limited) return ask_each(work, pairs, ask);
  in_order(world, std::span(work.pairs).first(work.pair_count), pairs, WorkStage::kContact,
           work.order);
  work.dear.clear();
  work.still_dear.clear();
  const bool first_is_due = !work.order.empty() && is_due(work.pairs[work.order.front()]);
  const std::span<const std::uint32_t> rest =
      ask_while_it_lasts(work, work.order, first_is_due, ask, work.dear);
  ask_each(work, rest, ask);  // without work: those that are known to stay clear need none
  ask_while_it_lasts(work, work.dear, false, ask, work.still_dear);
  for (const std::uint32_t i : pairs) {
    PairWork& pair = work.pairs[i];
    pair.effort.counts.pairs_waiting += pair.effort.contact_waits ? 1U : 0U;
    note_waiting(pair, WorkStage::kContact, !pair.effort.contact_waits && !may_go_on(pair));
  }
}

void share_touch_work(Scratch::Impl& work, std::span<const std::uint32_t> pairs) {
  const auto is_unasked = [&](std::uint32_t i) { return work.pairs[i].answer.touch_unasked; };
  const auto count =
      static_cast<std::uint64_t>(std::count_if(pairs.begin(), pairs.end(), is_unasked));
  if (count == 0) return;
  const std::uint64_t each =
      std::clamp(work.contact_budget.left(spent(work)) / count, kFirstShare, kMostContactTests);
  for (const std::uint32_t i : pairs)
    if (is_unasked(i)) work.pairs[i].effort.contact_cap = each;
}

}  // namespace mortise
