#include "server/standby.h"
#include "common/session/world/decisions.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;

/// A line on which the test tells the ticks; whoever listens is asked by `turn` what comes next.
struct Line final : StandbyChannel {
  std::function<std::vector<ToldTick>()> turn;
  std::vector<TakenTicks> confirmed;
  bool leads = true, another = false;

  std::vector<ToldTick> follow() override { return turn(); }
  void await_told(std::int64_t) override {}
  void confirm(const TakenTicks& taken) override { confirmed.push_back(taken); }
  bool leader_present() const override { return leads; }
  bool another_stands_by() const override { return another; }
  Status take_over() override { return ok(); }
  ServerInput take() override { return {}; }
  void publish_join_reply(const JoinReply&) override {}
  void publish_replies(std::span<const Reply>) override {}
  void publish_decisions(std::span<const Decision>) override {}
  void publish_standing(std::span<const StandingChange>) override {}
  void publish_refusals(std::span<const RefusedIncrement>) override {}
  void publish_poses(const PoseBatch&) override {}
  void publish_events(std::span<const ClashEvent>) override {}
  void publish_snapshot(Snapshot) override {}
  void publish_mesh(const std::string&, std::span<const std::byte>) override {}
  void publish_features(const FeatureTable&) override {}
  void publish_uploads(std::span<const UploadState>) override {}
  void publish_coming_mesh(const std::string&, std::span<const std::byte>) override {}
  void publish_pulse(const SessionPulse&) override {}
  bool has_readers() const override { return false; }
  ChannelCounters counters() const override { return {}; }
};

class StandbyTest : public ::testing::Test {
 protected:
  /// The next ticks of the one that leads.
  std::vector<ToldTick> ticks(std::size_t count) {
    std::vector<ToldTick> told;
    while (told.size() < count) {
      const StepReport report = step(leader_, {}, scratch_);
      FollowedTick tick;
      tick.tick = report.tick;
      tick.state_hash = report.state_hash;
      told.push_back({tick.tick, encode(tick)});
    }
    return told;
  }
  static Decision join_of_anna() {
    Decision join;
    join.kind = Decision::Kind::kJoin;
    join.user = UserId{1};
    join.user_name = "anna";
    join.role = Role::kDesigner;
    return join;
  }
  static Decision grab_of_red() {
    Decision grab;
    grab.kind = Decision::Kind::kGrab;
    grab.user = UserId{1};
    grab.part = kRed;
    return grab;
  }
  Result<bool> follow_with(
      std::deque<ToldTick> told = {}, const std::function<bool()>& stop = [] { return false; }) {
    return follow(line_, std::move(told), follower_, stop,
                  [this](const std::string& note) { notes_.push_back(note); });
  }

  World leader_ = small_world(), world_ = small_world();
  Scratch scratch_{1};
  SessionStatistics statistics_;
  Follower follower_{world_, statistics_, nullptr, 1};
  Line line_;
  std::vector<std::string> notes_;
};

TEST_F(StandbyTest, ItWaitsUntilWhatItWasNotToldIsInTheLog) {
  ticks(9);
  std::uint64_t logged = 0;
  line_.turn = [&] {
    std::vector<ToldTick> told = ticks(1);
    FollowedTick tick;
    EXPECT_TRUE(decode(told[0].bytes, tick));
    logged += 3;  // 9 with the third
    tick.logged_tick = logged;
    return std::vector<ToldTick>{{tick.tick, encode(tick)}};
  };
  std::deque<ToldTick> told;
  EXPECT_TRUE(await_leader(line_, told, [] { return false; }));
  EXPECT_EQ(told.size(), 3u);
  EXPECT_EQ(told.front().tick, 10u);

  // As long as nothing is told, nothing is known to be in the log.
  int turns = 0;
  told.clear();
  line_.turn = [] { return std::vector<ToldTick>{}; };
  EXPECT_FALSE(await_leader(line_, told, [&] { return ++turns > 20; }));
}

TEST_F(StandbyTest, WhatIsReceivedIsConfirmedAtOnceWithHowFarItIsComputed) {
  line_.turn = [&] { return ticks(line_.confirmed.size() < 5 ? 2 : 0); };
  line_.leads = false;
  const auto ended = follow_with();
  ASSERT_TRUE(ended) << ended.error().text;
  EXPECT_TRUE(*ended);
  ASSERT_EQ(line_.confirmed.size(), 5u);
  for (std::uint64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(line_.confirmed[i].received, 2 * i + 2);
    EXPECT_EQ(line_.confirmed[i].computed, i);
  }
  EXPECT_EQ(follower_.last_tick(), 10u) << "it leads when all is computed";
}

TEST_F(StandbyTest, ItIsInStepOnlyWhenWhatWasToldMeanwhileIsComputed) {
  line_.turn = [&] { return ticks(follower_.last_tick() < 10 ? 1 : 0); };
  line_.leads = false;
  const std::vector<ToldTick> meanwhile = ticks(50);
  EXPECT_TRUE(follow_with({meanwhile.begin(), meanwhile.end()}));
  EXPECT_EQ(notes_, std::vector<std::string>{"in step from tick 54 on"}) << "6 of 60 are left";
}

TEST_F(StandbyTest, FallingBehindIsSaidAndThatItIsOver) {
  bool was_behind = false;
  line_.turn = [&] {
    const std::uint64_t behind = leader_.tick - follower_.last_tick();
    was_behind |= behind >= 40;
    return ticks(was_behind ? 0 : 2);
  };
  line_.leads = false;
  EXPECT_TRUE(follow_with());
  ASSERT_EQ(notes_.size(), 3u);
  EXPECT_EQ(notes_[0], "in step from tick 1 on");
  EXPECT_EQ(notes_[1],
            "31 ticks of the one that leads are not computed yet: a take-over would wait for them");
  EXPECT_EQ(notes_[2], "in step again from tick 74 on");
  EXPECT_EQ(follower_.last_tick(), 80u);
}

TEST_F(StandbyTest, OneThatIsFarBehindCanBeStopped) {
  line_.turn = [&] { return ticks(1); };  // as fast as it computes
  const std::vector<ToldTick> meanwhile = ticks(20);
  const auto ended = follow_with({meanwhile.begin(), meanwhile.end()},
                                 [&] { return follower_.last_tick() == 100; });
  ASSERT_TRUE(ended);
  EXPECT_FALSE(*ended);
  EXPECT_EQ(line_.confirmed.back().received, kTakenAll);
}

/// Two would lead: which one has what was acknowledged, only the one that leads knows.
TEST_F(StandbyTest, OneBesideAnotherConfirmsNothingAndDoesNotTakeOver) {
  line_.turn = [&] { return ticks(follower_.last_tick() < 10 ? 1 : 0); };
  line_.leads = false;
  line_.another = true;
  const auto ended = follow_with();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Code::kRuntime);
  EXPECT_EQ(ended.error().text,
            "another server stands by for this session, and one is enough: this one ends");
  EXPECT_EQ(follower_.last_tick(), 10u);
  EXPECT_TRUE(line_.confirmed.empty());
}

/// The log of one that stands by: each tick, and the state when it is due, as the leader has it.
TEST_F(StandbyTest, ItsLogHasCheckpointsOfTheLeadersState) {
  struct Log final : SessionLogWriter {
    void record(TickRecord record) override { records.push_back(std::move(record)); }
    bool wants_state() const override { return wants; }
    Status close() override { return ok(); }
    std::uint64_t dropped_ticks() const override { return 0; }
    std::uint64_t bytes_written() const override { return 0; }
    Status status() const override { return ok(); }
    std::vector<TickRecord> records;
    bool wants = false;
  } log;
  CheckpointTimes never;
  never.work_s = never.changed_s = never.idle_s = 1e6;
  Follower follower(world_, statistics_, &log, 1, never);
  std::vector<std::vector<std::byte>> states;
  std::size_t checkpoints = 0;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    FollowedTick tick;
    if (i == 1) tick.decisions.push_back(join_of_anna());
    if (i == 2) tick.decisions.push_back(grab_of_red());
    if (i > 2) tick.increments.push_back({UserId{1}, kRed, i, {-0.2, 0.01, 0}, Vec3::Zero()});
    for (const Decision& decision : tick.decisions) apply_decision(leader_, decision);
    const StepReport report = step(leader_, tick.increments, scratch_);
    tick.tick = report.tick;
    tick.state_hash = report.state_hash;
    states.push_back(encode_state(leader_));
    log.wants = i == 30 || i == 80;
    ASSERT_TRUE(follower.take({tick.tick, encode(tick)}));
    ASSERT_EQ(log.records.size(), i);
    TickRecord& record = log.records.back();
    EXPECT_EQ(record.tick, i);
    EXPECT_EQ(record.increments.size(), tick.increments.size());
    if (!record.state) continue;
    ++checkpoints;
    EXPECT_EQ(record.state(), states.back()) << "tick " << i;
  }
  EXPECT_EQ(checkpoints, 2u);
}

TEST_F(StandbyTest, OneThatIsTooSlowEndsAndSaysSo) {
  const std::vector<ToldTick> same = ticks(1);
  line_.turn = [&] { return std::vector<ToldTick>(1000, same[0]); };
  const auto ended = follow_with();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Code::kRuntime);
  EXPECT_NE(ended.error().text.find("this host is too slow to stand by"), std::string::npos)
      << ended.error().text;
}

}  // namespace
}  // namespace mortise
