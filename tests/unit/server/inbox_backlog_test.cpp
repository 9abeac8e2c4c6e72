#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/unit/server/inbox_bench.h"

namespace mortise {
namespace {

using namespace mortise::testing;

struct Waited {
  std::size_t most = 0;             ///< increments of all, at the end of a tick
  double longest_s = 0.0;           ///< from sent to carried out
  double longest_of_later_s = 0.0;  ///< the same without the first two seconds
  std::size_t most_in_a_tick = 0;
};

class InboxBacklogTest : public InboxTest {
 protected:
  /// Anna's device sends `per_s` increments a second for `seconds`, and the session ticks.
  Waited drag(double per_s, double ticks_per_s, double seconds) {
    world_.tick_rate_hz = ticks_per_s;
    Waited waited;
    const std::int64_t start_ns = now_ns_;
    for (int tick = 1; tick <= seconds * ticks_per_s; ++tick) {
      now_ns_ = start_ns + static_cast<std::int64_t>(tick * 1e9 / ticks_per_s);
      waited = after_tick(waited, per_s, start_ns);
    }
    return waited;
  }
  Waited after_tick(Waited waited, double per_s, std::int64_t start_ns) {
    ServerInput input;
    for (; sent_ns(per_s, start_ns) <= now_ns_; ++seq_) {
      input.increments.push_back(increment("a", anna_, kRed, seq_ + 1));
      input.increments.back().sent_ns = sent_ns(per_s, start_ns);
    }
    admit(std::move(input));
    waited.most = std::max(waited.most, inbox_.waiting_increments());
    waited.most_in_a_tick = std::max(waited.most_in_a_tick, intake_.increments.size());
    for (const Increment& taken : intake_.increments) {
      const std::int64_t sent =
          start_ns + static_cast<std::int64_t>(static_cast<double>(taken.seq) * 1e9 / per_s);
      const double s = static_cast<double>(now_ns_ - sent) * 1e-9;
      waited.longest_s = std::max(waited.longest_s, s);
      if (now_ns_ - start_ns > 2 * kSecond_ns)
        waited.longest_of_later_s = std::max(waited.longest_of_later_s, s);
    }
    return waited;
  }
  std::int64_t sent_ns(double per_s, std::int64_t start_ns) const {
    return start_ns + static_cast<std::int64_t>(static_cast<double>(seq_ + 1) * 1e9 / per_s);
  }

  std::uint64_t seq_ = 0;
};

TEST_F(InboxBacklogTest, ThousandASecondForAMinuteDoNotPileUp) {
  const Waited waited = drag(1000.0, 60.0, 60.0);
  EXPECT_LE(waited.most, 200u);
  EXPECT_LE(waited.longest_s, 0.25);
  EXPECT_LE(waited.longest_of_later_s, 2.1 / 60.0) << "of two ticks";
  EXPECT_EQ(
      inbox_.counters().accepted + inbox_.counters().refused_in_all() + inbox_.waiting_increments(),
      seq_);
  EXPECT_LE(refused(Refusal::kRateTooHigh), 1u) << "that is what the rate admits";
}

TEST_F(InboxBacklogTest, ADeviceOf240HzInASlowSessionDoesNotPileUp) {
  const Waited waited = drag(240.0, 20.0, 60.0);
  EXPECT_LE(waited.most, 100u);
  EXPECT_LE(waited.longest_s, 0.5);
  EXPECT_LE(waited.longest_of_later_s, 2.1 / 20.0) << "of two ticks";
  EXPECT_EQ(inbox_.counters().refused_in_all(), 0u);
}

// The session stood still for a fifth of a second: 48 increments of a device of 240 Hz.
TEST_F(InboxBacklogTest, WhatPiledUpInASlowTickIsNoLongLeap) {
  (void)drag(240.0, 60.0, 3.0);
  const std::int64_t start_ns = now_ns_ - static_cast<std::int64_t>(3e9);
  now_ns_ += kSecond_ns / 5;
  Waited waited = after_tick({}, 240.0, start_ns);
  EXPECT_GE(waited.most, 40u);
  for (int tick = 0; tick < 12; ++tick) {
    now_ns_ += kSecond_ns / 60;
    waited = after_tick(waited, 240.0, start_ns);
  }
  EXPECT_LE(waited.most_in_a_tick, 9u) << "two ticks of this device";
  EXPECT_LE(inbox_.waiting_increments(), 1u);
}

// One that ticks far below its rate cannot work off what is sent: what waits is bounded, and what
// is refused is said.
TEST_F(InboxBacklogTest, WhatWaitsIsBoundedAndWhatIsBeyondIsRefused) {
  ServerInput pile;
  for (std::uint64_t seq = 1; seq <= 900; ++seq)
    pile.increments.push_back(increment("a", anna_, kRed, seq));
  admit(std::move(pile));
  for (std::uint64_t burst = 1; burst <= 20; ++burst) {
    now_ns_ += kSecond_ns;
    ServerInput more;
    for (std::uint64_t i = 1; i <= 900; ++i)
      more.increments.push_back(increment("a", anna_, kRed, 900 * burst + i));
    admit(std::move(more));
    ASSERT_LE(inbox_.waiting_increments(), InboxLimits{}.increments_waiting);
    ASSERT_FALSE(intake_.increments.empty());
    for (const Ack& ack : intake_.acks)
      ASSERT_LE(ack.seq, intake_.increments.back().seq) << "what waits is not acknowledged yet";
  }
  EXPECT_GT(refused(Refusal::kRateTooHigh), 10'000u);
  ASSERT_FALSE(intake_.refused.empty()) << "it is told";
  EXPECT_EQ(intake_.refused.front().reason, Refusal::kRateTooHigh);
  EXPECT_EQ(intake_.refused.front().user, anna_);
  EXPECT_EQ(
      inbox_.counters().accepted + inbox_.counters().refused_in_all() + inbox_.waiting_increments(),
      21u * 900u);
  std::uint64_t last = 0;  // and the order holds
  while (inbox_.waiting_increments() != 0) {
    admit({});
    for (const Increment& taken : intake_.increments) {
      ASSERT_GT(taken.seq, last);
      last = taken.seq;
    }
  }
}

// A part whose motion waits is still in its hand.
TEST_F(InboxBacklogTest, ALeaseDoesNotEndWhileIncrementsWait) {
  ServerInput pile;
  for (std::uint64_t seq = 1; seq <= 900; ++seq)
    pile.increments.push_back(increment("a", anna_, kRed, seq));
  admit(std::move(pile));
  while (inbox_.waiting_increments() > 0) {
    now_ns_ += 3 * kSecond_ns;  // longer than the lease
    admit({});
    ASSERT_EQ(world_.find(kRed)->holder, anna_);
  }
  now_ns_ += 3 * kSecond_ns;
  admit({});
  EXPECT_FALSE(world_.find(kRed)->holder);
}

// Who leaves and comes back at once has nothing to do with what was still waiting.
TEST_F(InboxBacklogTest, WhatWaitsOfSomebodyWhoIsGoneIsRefused) {
  ServerInput pile;
  for (std::uint64_t seq = 1; seq <= 100; ++seq)
    pile.increments.push_back(increment("a", anna_, kRed, seq));
  admit(std::move(pile));
  const std::size_t waiting = inbox_.waiting_increments();
  ASSERT_GT(waiting, 0u);
  ServerInput gone;
  gone.lost.push_back({UserId{}, "a", false});
  gone.joins.push_back({"c", 7, "anna", "designer"});
  admit(std::move(gone));
  EXPECT_EQ(inbox_.waiting_increments(), 0u);
  EXPECT_TRUE(intake_.increments.empty());
  EXPECT_EQ(refused(Refusal::kUnknownUser), waiting);
  EXPECT_TRUE(intake_.acks.empty() && intake_.refused.empty()) << "who has the id now hears of it";
  EXPECT_EQ(inbox_.users_present(), 2u);
}

/// A hand whose increments 1 to kMany come in one tick, behind a gap that is filled last.
class InboxRepeatTest : public InboxTest {
 protected:
  static constexpr std::uint64_t kMany = kMaxKeptIncrements;
  ServerInput all_at_once(const ClientKey& client = "a") {
    ServerInput input;
    for (std::uint64_t i = 0; i < kMany; ++i)
      input.increments.push_back(repeated(client, i + 1 < kMany ? i + 2 : 1));
    return input;
  }
  ReceivedIncrement repeated(const ClientKey& client, std::uint64_t seq) const {
    ReceivedIncrement received = increment(client, anna_, kRed, seq, Vec3(0.01, 0, 0));
    received.kept_from = 1;
    received.repeated = true;
    return received;
  }
  /// Goes on as a client does: what is not acknowledged is repeated.
  void settle(const ClientKey& client = "a") {
    for (int tick = 0; tick < 600; ++tick) {
      note();
      now_ns_ += kSecond_ns / 60;
      ServerInput input;
      for (std::uint64_t i = 1; i <= 16 && acked_ + i <= kMany; ++i)
        input.increments.push_back(repeated(client, acked_ + i));
      admit(std::move(input));
    }
    note();
  }
  void note() {
    for (const Increment& one : intake_.increments) ++taken_[one.seq];
    for (const RefusedIncrement& one : intake_.refused) told_.insert(one.seq);
    for (const Ack& ack : intake_.acks)
      if (ack.user == anna_) acked_ = std::max(acked_, ack.seq);
    for (std::uint64_t seq = 1; seq <= acked_; ++seq)
      silent_ += !taken_.contains(seq) && !told_.contains(seq);
  }

  std::map<std::uint64_t, int> taken_;
  std::set<std::uint64_t> told_;
  std::uint64_t acked_ = 0, silent_ = 0;
};

// More than may wait: whoever is told that all of it was taken holds it for done.
TEST_F(InboxRepeatTest, NoAcknowledgementPassesARefusalThatWasNotTold) {
  admit(all_at_once());
  settle();
  EXPECT_EQ(acked_, kMany);
  EXPECT_EQ(silent_, 0u);
  EXPECT_EQ(inbox_.counters().refusals_untold, 0u);
  EXPECT_EQ(inbox_.counters().accepted + inbox_.counters().refused_in_all(), kMany);
  EXPECT_EQ(inbox_.counters().repaired, kMany);
  EXPECT_EQ(inbox_.counters().lost, 0u);
}

// The acknowledgements did not arrive before she was taken for gone.
TEST_F(InboxRepeatTest, WhoComesBackIsNotTakenTwice) {
  admit(all_at_once());
  for (int tick = 0; tick < 9; ++tick) {
    for (const Increment& one : intake_.increments) ++taken_[one.seq];
    admit({});
  }
  for (const Increment& one : intake_.increments) ++taken_[one.seq];
  ASSERT_GE(taken_.size(), 50u);
  ServerInput gone;
  gone.lost.push_back({UserId{}, "a", false});
  gone.joins.push_back({"a", 1, "anna", "designer"});
  admit(std::move(gone));
  ASSERT_EQ(intake_.join_replies.front().user, anna_);
  ASSERT_EQ(command("a", anna_, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  settle();
  EXPECT_EQ(acked_, kMany);
  EXPECT_EQ(silent_, 0u);
  for (const auto& [seq, times] : taken_) EXPECT_EQ(times, 1) << seq;
}

// Somebody else under this name counts from 1.
TEST_F(InboxRepeatTest, WhoComesInsteadBeginsAnew) {
  admit(all_at_once());
  ServerInput gone;
  gone.lost.push_back({UserId{}, "a", false});
  gone.joins.push_back({"c", 1, "anna", "designer"});
  admit(std::move(gone));
  ASSERT_EQ(intake_.join_replies.front().user, anna_);
  ASSERT_EQ(command("c", anna_, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  taken_.clear();
  settle("c");
  EXPECT_EQ(acked_, kMany);
  EXPECT_EQ(silent_, 0u);
  EXPECT_EQ(taken_.size(), kMany);
}

}  // namespace
}  // namespace mortise
