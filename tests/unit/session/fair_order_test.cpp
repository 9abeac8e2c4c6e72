// However little work ticks have, each pair that asks for some is served within a bound: needs,
// arrivals, hands, budgets and what else a tick spends are drawn at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "common/session/tick/contact_budget.h"
#include "common/session/tick/depth_budget.h"

namespace mortise {
namespace {

class FairPlay {
 public:
  FairPlay(std::uint64_t seed, std::uint32_t pairs, WorkStage stage)
      : random_(seed), stage_(stage), memos_(pairs), shy_(pairs), waiting_(pairs), served_(pairs) {
    world_.tick_rate_hz = 1e6;  // the least work that a tick may have
    world_.tick = 1;
    world_.policy = Policy::kStop;
    world_.parts.resize(pairs);
    work().pairs.resize(pairs);
    work().pair_count = pairs;
    for (std::uint32_t i = 0; i < pairs; ++i) shy_[i] = draw(4) == 0;
    need_most_ = 100 + draw(stage == WorkStage::kContact ? 80'000 : 8'000);
    besides_most_ = draw(2) == 0 ? 0 : 100'000;
  }

  // The longest that a pair has asked in vain, in ticks.
  std::uint64_t play(std::uint64_t ticks) {
    std::uint64_t longest = 0;
    for (std::uint64_t i = 0; i < ticks; ++i) {
      tick();
      longest = std::max<std::uint64_t>(longest, std::ranges::max(waiting_));
    }
    return longest;
  }
  std::uint64_t unserved() const { return unserved_; }

 private:
  std::uint64_t draw(std::uint64_t below) { return random_() % below; }
  Scratch::Impl& work() { return scratch_.impl(); }

  void tick() {
    ++world_.tick;
    open_contact_budget(world_, state_, work());
    open_depth_budget(world_, state_, work());
    std::vector<std::uint32_t> asking;
    for (std::uint32_t i = 0; i < memos_.size(); ++i) {
      PairWork& pair = work().pairs[i];
      pair = PairWork{};
      pair.ids.a = pair.ids.b = i;
      pair.ids.move_a = 0;
      pair.ids.memo = MemoInUse(memos_[i]);
      if (draw(100) == 0) world_.parts[i].holder = UserId{static_cast<std::uint32_t>(draw(2))};
      if (!shy_[i] || draw(3) == 0) asking.push_back(i);
    }
    if (stage_ != WorkStage::kContact && !asking.empty() && besides_most_ > 0)
      work().pairs[asking[0]].effort.counts.depth_evaluations +=
          draw(besides_most_);  // other stages
    std::fill(served_.begin(), served_.end(), false);
    ask(asking);
    std::vector<std::uint32_t> again;  // whose parts were stopped: another round of the response
    for (const std::uint32_t i : asking)
      if (i % 2 == 1) again.push_back(i);
    ask(again);
    if (stage_ == WorkStage::kContact && besides_most_ > 0 && !asking.empty())
      work().pairs[asking[0]].effort.contact_tests += draw(besides_most_);  // what is told
    close_contact_budget(state_, work());
    close_depth_budget(state_, work());
    for (std::uint32_t i = 0; i < memos_.size(); ++i) {
      const bool in_vain = std::ranges::binary_search(asking, i) && !served_[i];
      waiting_[i] = in_vain ? waiting_[i] + 1 : 0;
      unserved_ += in_vain ? 1 : 0;
    }
  }

  void ask(const std::vector<std::uint32_t>& pairs) {
    if (stage_ == WorkStage::kContact)
      return ask_in_turn(world_, work(), pairs, [&](PairWork& pair, CcdScratch&) {
        const std::uint64_t need = 1 + draw(need_most_);
        pair.effort.contact_waits = pair.effort.contact_cap == 0;
        pair.effort.contact_short = !pair.effort.contact_waits && need > pair.effort.contact_cap;
        pair.effort.contact_tests += std::min(need, pair.effort.contact_cap);
        if (!pair.effort.contact_waits &&
            (!pair.effort.contact_short || pair.effort.contact_cap >= kMostContactTests))
          served_[pair.ids.a] = true;
      });
    for (const std::uint32_t i : pairs) work().pairs[i].effort.counts.pairs_waiting = 0;
    serve_in_turn(world_, work(), pairs, stage_, [&](PairWork& pair, CcdScratch&) {
      const std::uint64_t need = 1 + draw(need_most_);
      pair.effort.counts.depth_evaluations += std::min(need, pair.effort.cap);
      if (pair.effort.counts.pairs_waiting > 0) return;
      note_depth_effort(pair, stage_, need > pair.effort.cap);
      served_[pair.ids.a] = true;
    });
  }

  std::mt19937_64 random_;
  WorkStage stage_;
  World world_;
  SessionState state_;
  Scratch scratch_{1};
  std::vector<PairMemo> memos_;
  std::vector<bool> shy_;  // does not ask in each tick
  std::vector<std::uint64_t> waiting_;
  std::vector<bool> served_;
  std::uint64_t need_most_ = 0, besides_most_ = 0, unserved_ = 0;
};

void expect_fair(WorkStage stage) {
  std::uint64_t unserved = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    // Few, and in some plays more than there are ticks in any count of them that is kept short.
    const std::uint32_t pairs = seed % 12 == 0 ? 300 : 1 + static_cast<std::uint32_t>(seed);
    FairPlay play(seed, pairs, stage);
    const std::uint64_t bound = longest_wait_ticks(pairs);
    EXPECT_LE(play.play(bound + bound / 2), bound) << pairs << " pairs, seed " << seed;
    unserved += play.unserved();
  }
  EXPECT_GT(unserved, 50'000U) << "nobody had to wait: nothing is shown";
}

// Who is asked again in a round of the response does not become older than others by it.
TEST(FairOrder, APairAgesOnceInATick) {
  PairMemo memo;
  for (std::uint32_t tick = 1; tick <= 600; ++tick) {
    PairWork pair;
    pair.ids.memo = MemoInUse(memo);
    for (int round = 0; round < 3; ++round) note_waiting(pair, WorkStage::kContact, false);
    ASSERT_EQ(waited_of(pair, WorkStage::kContact), tick);
    ASSERT_EQ(waited_of(pair, WorkStage::kVerdict), 0U);
  }
  PairWork pair;
  pair.ids.memo = MemoInUse(memo);
  note_waiting(pair, WorkStage::kContact, true);
  EXPECT_EQ(waited_of(pair, WorkStage::kContact), 0U);
}

TEST(FairOrder, FirstContact) { expect_fair(WorkStage::kContact); }
TEST(FairOrder, SearchForTheStop) { expect_fair(WorkStage::kStop); }
TEST(FairOrder, Verdict) { expect_fair(WorkStage::kVerdict); }

}  // namespace
}  // namespace mortise
