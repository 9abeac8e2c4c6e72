#include "server/held_channel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

namespace mortise {
namespace {

/// A clock that goes on as the test says.
struct StillClock final : Clock {
  std::int64_t at_ns = 1;
  std::int64_t now_ns() override { return at_ns; }
  std::int64_t wall_ns() override { return at_ns; }
  void sleep_until_ns(std::int64_t deadline_ns) override { at_ns = deadline_ns; }
};

/// Writes down what reaches clients; one that stands by takes what the test lets it take.
struct Wire final : ServerChannel {
  StillClock* clock = nullptr;
  std::vector<std::uint64_t> said;  ///< ticks of pose batches
  std::uint64_t taken = 0, told = 0, not_computed = 0;
  ClientKey by;  ///< who took it
  int led_anew = 0;
  ServerInput input;
  std::int64_t superseded_after_ns = 0;  ///< 0: never
  std::int64_t follower_goes_ns = std::numeric_limits<std::int64_t>::max();

  ServerInput take() override {
    input.superseded |= superseded_after_ns != 0 && clock->at_ns >= superseded_after_ns;
    return std::exchange(input, {});
  }
  void publish_join_reply(const JoinReply&) override {}
  void publish_replies(std::span<const Reply>) override {}
  void publish_decisions(std::span<const Decision>) override {}
  void publish_standing(std::span<const StandingChange>) override {}
  void publish_refusals(std::span<const RefusedIncrement>) override {}
  void publish_poses(const PoseBatch& batch) override { said.push_back(batch.tick); }
  void publish_events(std::span<const ClashEvent>) override {}
  void publish_snapshot(Snapshot) override {}
  void publish_mesh(const std::string&, std::span<const std::byte>) override {}
  void publish_features(const FeatureTable&) override {}
  void publish_uploads(std::span<const UploadState>) override {}
  void publish_coming_mesh(const std::string&, std::span<const std::byte>) override {}
  void publish_pulse(const SessionPulse&) override {}
  bool has_readers() const override { return true; }
  ChannelCounters counters() const override { return {}; }
  bool has_follower() const override { return clock->at_ns < follower_goes_ns; }
  void publish_tick(const ToldTick& tick) override { told = tick.tick; }
  TakenTicks taken_up_to() override {
    const std::uint64_t received = std::exchange(taken, 0);
    return {received, received - std::min(received, not_computed), by};
  }
  void await_taken(std::int64_t at_most_ns) override { clock->at_ns += at_most_ns; }
  void lead_anew() override { ++led_anew; }
};

class Held : public ::testing::Test {
 protected:
  Held() { wire_.clock = &clock_; }
  void tick(std::uint64_t number) {
    (void)held_.take();
    held_.publish_tick({number, {}});
    PoseBatch batch;
    batch.tick = number;
    held_.publish_poses(batch);
  }
  /// The one that stands by says to have `tick`.
  void taken(std::uint64_t tick) {
    wire_.taken = tick;
    (void)held_.take();
  }
  void rest(double seconds) {
    for (const std::int64_t end_ns = clock_.at_ns + static_cast<std::int64_t>(seconds * 1e9);
         clock_.at_ns < end_ns && held_.rest(end_ns - clock_.at_ns);) {
    }
  }
  void hear(std::initializer_list<std::uint32_t> users) {
    for (const std::uint32_t user : users) wire_.input.heartbeats.push_back(UserId{user});
    (void)held_.take();
  }

  StillClock clock_;
  Wire wire_;
  std::size_t users_ = 3;
  HeldChannel held_{wire_, clock_, [this] { return users_; }};
};

using Ticks = std::vector<std::uint64_t>;

TEST_F(Held, SaysAllAtOnceWhileNobodyIsInStep) {
  tick(1);
  tick(2);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.told, 2u);
  taken(1);  // far behind is as good as not there
  for (std::uint64_t t = 3; t < 100; ++t) tick(t);
  EXPECT_FALSE(wire_.said.empty());
}

TEST_F(Held, KeepsWhatTheSecondHasNot) {
  tick(1);
  taken(1);
  tick(2);
  tick(3);
  EXPECT_EQ(wire_.said, Ticks{1});
  rest(0.1);
  EXPECT_EQ(wire_.said, Ticks{1});
  taken(2);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  taken(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3}));
}

/// What it has received is safe there, and clients may know of it; it is not in step all the same.
TEST_F(Held, OneThatComputesLateIsSaidAndCountedAndKeepsNobodyWaiting) {
  tick(1);
  wire_.not_computed = 200;
  taken(1);
  EXPECT_TRUE(held_.follower_in_step()) << "one tick";
  for (std::uint64_t t = 2; t <= 100; ++t) tick(t);
  taken(100);
  EXPECT_EQ(wire_.said.back(), 100u);
  EXPECT_FALSE(held_.follower_in_step());
  EXPECT_EQ(held_.take_notes(),
            std::vector<std::string>{"the server that stands by has 100 ticks that it has not "
                                     "computed yet: if this one were gone, users would wait for "
                                     "that"});
  tick(101);
  EXPECT_EQ(wire_.said.back(), 100u) << "and is waited for";
  wire_.not_computed = 20;
  taken(101);
  EXPECT_FALSE(held_.follower_in_step());
  EXPECT_TRUE(held_.take_notes().empty());
  tick(102);
  wire_.not_computed = 1;
  taken(102);
  EXPECT_TRUE(held_.follower_in_step());
  EXPECT_EQ(held_.take_notes(),
            std::vector<std::string>{"the server that stands by is in step again"});
  EXPECT_EQ(held_.follower_backlog().times_behind(), 1u);
  EXPECT_EQ(held_.follower_backlog().longest_ticks(), 100u);
}

/// Also where nobody is told anything, so that nobody waits for it.
TEST_F(Held, OneThatIsGoneIsNotInStep) {
  tick(1);
  taken(1);
  ASSERT_TRUE(held_.follower_backlog().in_step());
  wire_.follower_goes_ns = clock_.at_ns;
  EXPECT_FALSE(held_.follower_backlog().in_step());
  EXPECT_FALSE(held_.follower_in_step());
}

TEST_F(Held, NothingIsSaidOfWhatWasKeptWhenAnotherLeads) {
  tick(1);
  taken(1);
  tick(2);
  wire_.input.superseded = true;
  wire_.taken = 2;  // said by nobody who could know
  (void)held_.take();
  EXPECT_EQ(wire_.said, Ticks{1});
}

TEST_F(Held, OneThatTellsNoTickLeadsNobody) {
  FollowedTick tick;
  tick.tick = 7;
  const ToldTick good{7, encode(tick)};
  const auto superseded_by = [&](const ToldTick& told) {
    wire_.input.superseded = true;
    wire_.input.superseding = told;
    return held_.take().superseded;
  };
  EXPECT_TRUE(superseded_by(good));
  EXPECT_FALSE(superseded_by({7, {}}));
  EXPECT_FALSE(superseded_by({0, {}}));
  EXPECT_FALSE(superseded_by({8, good.bytes})) << "it says another number outside than inside";
  EXPECT_FALSE(superseded_by({7, std::vector<std::byte>(good.bytes.size(), std::byte{0x5a})}));
}

TEST_F(Held, WhatIsHandedOverIsSaidOnceTheOtherHasIt) {
  tick(1);
  taken(1);
  tick(2);
  wire_.taken = 2;
  wire_.superseded_after_ns = clock_.at_ns + 50'000'000;
  EXPECT_TRUE(held_.hand_over([] { return true; }));
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.led_anew, 0);
}

TEST_F(Held, WhatTheOtherDoesNotTakeIsNeverSaidAndNobodyLeadsAnew) {
  tick(1);
  taken(1);
  tick(2);
  const std::int64_t begun_ns = clock_.at_ns;
  EXPECT_FALSE(held_.hand_over([] { return true; }));
  EXPECT_NEAR(static_cast<double>(clock_.at_ns - begun_ns) * 1e-9, HeldChannel::kHandOver_s, 0.1);
  held_.finish();
  EXPECT_EQ(wire_.said, Ticks{1});
  EXPECT_EQ(wire_.led_anew, 0) << "it may be leading by now";
}

TEST_F(Held, OneThatIsGoneIsNotWaitedForToLead) {
  tick(1);
  taken(1);
  tick(2);
  const std::int64_t begun_ns = clock_.at_ns;
  wire_.follower_goes_ns = begun_ns + 500'000'000;
  EXPECT_FALSE(held_.hand_over([] { return true; }));
  EXPECT_NEAR(static_cast<double>(clock_.at_ns - begun_ns) * 1e-9, 0.5, 0.1);
  EXPECT_EQ(wire_.said, Ticks{1});
}

TEST_F(Held, WhoIsToldToEndWaitsForNobodyToLead) {
  tick(1);
  taken(1);
  tick(2);
  const std::int64_t begun_ns = clock_.at_ns;
  int turns = 0;
  EXPECT_FALSE(held_.hand_over([&] { return ++turns < 10; }));
  EXPECT_EQ(turns, 10);
  EXPECT_LT(static_cast<double>(clock_.at_ns - begun_ns) * 1e-9, 0.5);
  EXPECT_EQ(wire_.said, Ticks{1});
}

TEST_F(Held, ASilentSecondIsGivenUpAndThatIsSaid) {
  tick(1);
  taken(1);
  tick(2);
  rest(0.25);
  hear({1, 2});
  rest(0.2);
  EXPECT_EQ(wire_.said, Ticks{1});
  rest(0.1);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.led_anew, 1);
  ASSERT_EQ(held_.take_notes().size(), 1u);
  tick(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3})) << "no more waiting";
  taken(3);
  tick(4);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3})) << "it is back, and waited for";
}

TEST_F(Held, AFreezeOfThisProcessIsNotTheSilenceOfTheOther) {
  tick(1);
  taken(1);
  tick(2);
  hear({1, 2});
  clock_.at_ns += 10'000'000'000;  // stood still
  (void)held_.take();
  EXPECT_EQ(wire_.said, Ticks{1});
  EXPECT_EQ(wire_.led_anew, 0);
}

TEST_F(Held, OneThatHearsNeitherItsSecondNorMostUsersWaitsLonger) {
  tick(1);
  taken(1);
  tick(2);
  hear({1, 2, 3});  // was on its way
  rest(2.0);
  hear({1, 2, 3});  // back, and perhaps with another server since
  rest(1.5);
  EXPECT_EQ(wire_.said, Ticks{1}) << "it may be the one that is cut off";
  rest(0.7);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.led_anew, 0);
}

TEST_F(Held, OneThatStaysAloneGoesOnWithoutAHigherTerm) {
  tick(1);
  taken(1);
  tick(2);
  rest(4.2);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.led_anew, 0) << "whoever leads the others is not to be ended by this one";
}

TEST_F(Held, ASecondThatGoesIsNotWaitedFor) {
  tick(1);
  taken(1);
  tick(2);
  taken(kTakenAll);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  tick(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3}));
  EXPECT_TRUE(held_.take_notes().empty());
}

TEST_F(Held, OneThatTookOverSpeaksWhenHalfOfItsUsersHaveCome) {
  held_.await({{UserId{1}, "a", 1}, {UserId{2}, "b", 1}, {UserId{3}, "c", 1}});
  tick(1);
  wire_.input.joins.push_back({"a", 1, "anna", "designer"});
  tick(2);
  rest(1.0);
  EXPECT_TRUE(wire_.said.empty());
  wire_.input.joins.push_back({"c", 1, "cleo", "designer"});
  tick(3);
  rest(0.01);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3}));
}

/// A gateway or a bot holds many users: half of the clients may be few of them, or one most.
TEST_F(Held, OneThatTookOverCountsUsersNotClients) {
  std::vector<SeatRecord> seats;
  for (std::uint32_t i = 1; i <= 6; ++i) seats.push_back({UserId{i}, "gateway", i});
  seats.push_back({UserId{7}, "a", 1});
  seats.push_back({UserId{8}, "b", 1});
  held_.await(seats);
  tick(1);
  wire_.input.joins.push_back({"a", 1, "anna", "designer"});
  wire_.input.joins.push_back({"b", 1, "ben", "designer"});
  tick(2);
  rest(1.0);
  EXPECT_TRUE(wire_.said.empty()) << "two of eight";
  for (std::uint64_t nonce : {1, 2, 2}) wire_.input.joins.push_back({"gateway", nonce, "g", "bot"});
  tick(3);
  rest(0.01);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3})) << "four of eight";
}

TEST_F(Held, OneThatTookOverAndStaysAloneSaysSo) {
  held_.await({{UserId{1}, "a", 0}, {UserId{2}, "b", 0}});
  tick(1);
  rest(4.2);
  EXPECT_EQ(wire_.said, Ticks{1});
  ASSERT_EQ(held_.take_notes().size(), 1u);
}

TEST_F(Held, AtTheEndAllIsSaid) {
  tick(1);
  taken(1);
  tick(2);
  held_.finish();
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
}

/// Says what the test lets it say.
struct Word final : Fencing {
  std::set<ClientKey> possible{ClientKey{}};
  std::vector<ClientKey> asked;
  bool holds = true;
  bool may_say(const ClientKey& has_it) const override {
    return holds && std::all_of(possible.begin(), possible.end(),
                                [&](const ClientKey& who) { return who.empty() || who == has_it; });
  }
  void ask(const ClientKey& who) override {
    if (!asked.empty() && asked.back() == who) return;
    asked.push_back(who);
    possible.insert(who);
  }
  std::string barred() const override { return {}; }
  void grant() { possible = {asked.back()}; }
};

class HeldByWord : public Held {
 protected:
  HeldByWord() { wire_.by = "second"; }
  Word word_;
  HeldChannel fenced_{wire_, clock_, [this] { return users_; }, &word_};
  void tell(std::uint64_t number) {
    (void)fenced_.take();
    fenced_.publish_tick({number, {}});
    PoseBatch batch;
    batch.tick = number;
    fenced_.publish_poses(batch);
  }
  void second_has(std::uint64_t number) {
    wire_.taken = number;
    (void)fenced_.take();
  }
  void wait(double seconds) {
    for (const std::int64_t end_ns = clock_.at_ns + static_cast<std::int64_t>(seconds * 1e9);
         clock_.at_ns < end_ns && fenced_.rest(end_ns - clock_.at_ns);) {
    }
  }
};

TEST_F(HeldByWord, OneThatStandsByMayTakeOverOnceItHasAllThatWasSaid) {
  tell(1);
  tell(2);
  second_has(1);
  EXPECT_TRUE(word_.asked.empty()) << "it has not what was said";
  tell(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2})) << "kept from now on";
  second_has(2);
  EXPECT_EQ(word_.asked, std::vector<ClientKey>{"second"});
  second_has(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3})) << "whether or not it is granted: it has that";
}

TEST_F(HeldByWord, GoesOnAloneOnlyOnceNobodyMayTakeOver) {
  tell(1);
  second_has(1);
  word_.grant();
  tell(2);
  wait(10.0);
  EXPECT_EQ(word_.asked.back(), "");
  EXPECT_EQ(wire_.said, Ticks{1}) << "the second may lead, for all that is known";
  EXPECT_EQ(wire_.led_anew, 0);
  word_.grant();
  wait(0.1);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
  EXPECT_EQ(wire_.led_anew, 1);
}

TEST_F(HeldByWord, SaysNothingWithoutItsLease) {
  word_.holds = false;
  tell(1);
  second_has(1);
  wait(1.0);
  EXPECT_TRUE(wire_.said.empty());
  fenced_.finish();
  EXPECT_TRUE(wire_.said.empty()) << "nor at its end";
  word_.holds = true;
  tell(2);
  second_has(2);
  EXPECT_EQ(wire_.said, (Ticks{1, 2}));
}

TEST_F(HeldByWord, WhatAnotherStandbyHasIsNotSaidWhileTheFirstMayLead) {
  tell(1);
  second_has(1);
  word_.grant();
  wire_.by = "third";
  tell(2);
  second_has(2);
  EXPECT_EQ(wire_.said, Ticks{1});
  EXPECT_EQ(word_.asked.back(), "third");
  word_.grant();
  tell(3);
  second_has(3);
  EXPECT_EQ(wire_.said, (Ticks{1, 2, 3}));
}

}  // namespace
}  // namespace mortise
