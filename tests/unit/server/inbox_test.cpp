#include "server/inbox.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/numbers.h"
#include "tests/unit/server/inbox_bench.h"

namespace mortise {
namespace {

using namespace mortise::testing;

TEST(SequenceWindow, TellsNewRepeatedAndLate) {
  SequenceWindow window;
  EXPECT_EQ(window.admit(0), Refusal::kStale);
  EXPECT_EQ(window.admit(1), Refusal::kNone);
  EXPECT_EQ(window.admit(1), Refusal::kDuplicate);
  EXPECT_EQ(window.admit(5), Refusal::kNone);
  EXPECT_EQ(window.admit(3), Refusal::kStale);      // lost before, now late
  EXPECT_EQ(window.admit(3), Refusal::kDuplicate);  // and repeated
  EXPECT_EQ(window.admit(1), Refusal::kDuplicate);
  EXPECT_EQ(window.admit(69), Refusal::kNone);
  EXPECT_EQ(window.admit(5), Refusal::kStale);  // beyond the memory of 64
  EXPECT_EQ(window.admit(6), Refusal::kStale);
  EXPECT_EQ(window.admit(69), Refusal::kDuplicate);
  EXPECT_EQ(window.newest(), 69U);
}

TEST_F(InboxTest, AcceptsTheHolderInOrderAndAcknowledges) {
  ServerInput input;
  for (std::uint64_t seq = 1; seq <= 3; ++seq) {
    input.increments.push_back(increment("a", anna_, kRed, seq));
  }
  admit(std::move(input));
  ASSERT_EQ(intake_.increments.size(), 3U);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(intake_.increments[i].seq, i + 1);
  ASSERT_EQ(intake_.acks.size(), 1U);
  EXPECT_EQ(intake_.acks[0].user, anna_);
  EXPECT_EQ(intake_.acks[0].seq, 3U);
  EXPECT_EQ(intake_.acks[0].sent_ns, 30);
  EXPECT_EQ(inbox_.counters().accepted, 3U);
  EXPECT_TRUE(intake_.refused.empty());
}

TEST_F(InboxTest, DropsRepeatsAndLateOnesAndCountsThem) {
  EXPECT_EQ(send(increment("a", anna_, kRed, 4)), Refusal::kNone);
  EXPECT_EQ(send(increment("a", anna_, kRed, 4)), Refusal::kDuplicate);
  EXPECT_EQ(send(increment("a", anna_, kRed, 2)), Refusal::kStale);
  EXPECT_EQ(send(increment("a", anna_, kRed, 5)), Refusal::kNone);
  EXPECT_EQ(refused(Refusal::kDuplicate), 1U);
  EXPECT_EQ(refused(Refusal::kStale), 1U);
}

TEST_F(InboxTest, RefusesWhatIsNotANumberOrTooLarge) {
  const auto with = [&](std::uint64_t seq, const Vec3& by, const Vec3& turn) {
    ReceivedIncrement r = increment("a", anna_, kRed, seq, by);
    r.increment.rotation_rad = turn;
    return r;
  };
  std::uint64_t seq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (double bad : {kNan, kInf, -kInf}) {
      Vec3 v = Vec3::Zero();
      v[axis] = bad;
      EXPECT_EQ(send(with(++seq, v, Vec3::Zero())), Refusal::kNotFinite);
      EXPECT_EQ(send(with(++seq, Vec3::Zero(), v)), Refusal::kNotFinite);
    }
  }
  EXPECT_EQ(send(with(++seq, {50.0, 0, 0}, Vec3::Zero())), Refusal::kNone);
  EXPECT_EQ(send(with(++seq, {50.001, 0, 0}, Vec3::Zero())), Refusal::kJumpTooLarge);
  EXPECT_EQ(send(with(++seq, {1e300, 1e300, 0}, Vec3::Zero())), Refusal::kJumpTooLarge);
  EXPECT_EQ(send(with(++seq, Vec3::Zero(), {0, 0, 3.2})), Refusal::kRotationTooLarge);
  EXPECT_EQ(send(with(++seq, Vec3::Zero(), {1e308, 1e308, 1e308})), Refusal::kRotationTooLarge);
  EXPECT_EQ(refused(Refusal::kNotFinite), 18U);
}

TEST_F(InboxTest, RefusesPartsThatAreNotInTheSendersHand) {
  EXPECT_EQ(send(increment("a", anna_, kBlue, 1)), Refusal::kNotHolder);
  EXPECT_EQ(send(increment("b", ben_, kRed, 1)), Refusal::kNotHolder);
  EXPECT_EQ(send(increment("a", anna_, kWall, 2)), Refusal::kPartIsStatic);
  EXPECT_EQ(send(increment("a", anna_, PartId{9}, 3)), Refusal::kUnknownPart);
  EXPECT_EQ(send(increment("a", anna_, PartId{}, 4)), Refusal::kUnknownPart);
  EXPECT_EQ(send(increment("a", anna_, kRed, 5)), Refusal::kNone);
}

TEST_F(InboxTest, RefusesAForeignSenderAndLeavesTheUserAlone) {
  EXPECT_EQ(send(increment("b", anna_, kRed, 100)), Refusal::kUnknownUser);
  EXPECT_EQ(intake_.refused.front().user, ben_) << "told to who sent it, not to who was named";
  EXPECT_TRUE(intake_.acks.empty());
  EXPECT_EQ(send(increment("?", UserId{77}, kRed, 1)), Refusal::kUnknownUser);
  EXPECT_EQ(inbox_.counters().foreign, 1U);
  // Anna's own sequence was not touched by the 100.
  EXPECT_EQ(send(increment("a", anna_, kRed, 1)), Refusal::kNone);
}

TEST_F(InboxTest, RefusesAForeignCommandAndAForeignGoodbye) {
  EXPECT_EQ(command("b", anna_, kRed, CommandKind::kRelease).refusal, Refusal::kUnknownUser);
  ServerInput input;
  input.lost.push_back({anna_, "b", true});
  admit(std::move(input));
  EXPECT_EQ(world_.find(kRed)->holder, anna_);
  EXPECT_TRUE(world_.find(anna_)->present);
  EXPECT_EQ(inbox_.counters().foreign, 2U);
}

TEST_F(InboxTest, WhatTheDoorRefusedIsToldCountedAndAcknowledgedOutOfNobodysWay) {
  ServerInput input;
  input.increments.push_back(increment("a", anna_, kRed, 1));
  input.increments.push_back(increment("a", anna_, kRed, 2));
  input.increments.back().sent_ns = 0;
  input.increments.back().at_door = Refusal::kNotFinite;
  admit(std::move(input));
  EXPECT_EQ(intake_.increments.size(), 1U) << "a later refusal must not make the first one late";
  ASSERT_EQ(intake_.refused.size(), 1U);
  EXPECT_EQ(intake_.refused[0].reason, Refusal::kNotFinite);
  ASSERT_EQ(intake_.acks.size(), 1U);
  EXPECT_EQ(intake_.acks[0].seq, 2U);
  EXPECT_EQ(intake_.acks[0].sent_ns, 10) << "the latency figure is of the accepted one";
  EXPECT_EQ(refused(Refusal::kNotFinite), 1U);
}

TEST_F(InboxTest, GrabOfAHeldPartNamesTheHolder) {
  const Reply reply = command("b", ben_, kRed, CommandKind::kGrab);
  EXPECT_EQ(reply.refusal, Refusal::kHeldByOther);
  EXPECT_EQ(reply.holder, anna_);
  EXPECT_NE(reply.text.find("anna"), std::string::npos) << reply.text;
  EXPECT_TRUE(intake_.decisions.empty());
}

TEST_F(InboxTest, ARepeatedCommandIsNotCarriedOutTwice) {
  ServerInput input;
  input.commands.push_back({"a", {anna_, kRed, 50, CommandKind::kRelease}});
  input.commands.push_back({"a", {anna_, kRed, 50, CommandKind::kRelease}});
  admit(std::move(input));
  ASSERT_EQ(intake_.replies.size(), 2U);
  EXPECT_EQ(intake_.replies[0].refusal, Refusal::kNone);
  EXPECT_EQ(intake_.replies[1].refusal, Refusal::kDuplicate);
  EXPECT_EQ(intake_.decisions.size(), 1U);
}

TEST_F(InboxTest, AReleaseWaitsForTheIncrementsBeforeIt) {
  ServerInput input;
  input.increments.push_back(increment("a", anna_, kRed, 1));
  input.commands.push_back({"a", {anna_, kRed, ++command_seq_, CommandKind::kRelease}});
  input.commands.push_back({"a", {anna_, kBlue, ++command_seq_, CommandKind::kGrab}});
  admit(std::move(input));
  EXPECT_EQ(intake_.increments.size(), 1U);
  EXPECT_EQ(world_.find(kRed)->holder, anna_);
  EXPECT_EQ(world_.find(kBlue)->holder, anna_) << "another part need not wait";
  admit({});
  EXPECT_FALSE(world_.find(kRed)->holder);
  ASSERT_EQ(intake_.replies.size(), 1U);
  EXPECT_EQ(intake_.replies[0].refusal, Refusal::kNone);
}

TEST_F(InboxTest, ABacklogIsWorkedOffInOrderAndWhatWasSentAfterItWaits) {
  const std::uint32_t share = InboxLimits{}.increments_per_tick;
  ServerInput pile;  // what a slow tick leaves behind: a drag, its release, and a goodbye
  const std::uint64_t sent = 2 * share + 3;
  for (std::uint64_t seq = 1; seq <= sent; ++seq) {
    pile.increments.push_back(increment("a", anna_, kRed, seq));
  }
  pile.commands.push_back({"a", {anna_, kRed, ++command_seq_, CommandKind::kRelease}});
  pile.lost.push_back({anna_, "a", true});
  admit(std::move(pile));
  std::uint64_t next = 1;
  for (std::size_t expected : {std::size_t{share}, std::size_t{share}, std::size_t{3}}) {
    ASSERT_EQ(intake_.increments.size(), expected);
    for (const Increment& taken : intake_.increments) EXPECT_EQ(taken.seq, next++);
    EXPECT_EQ(intake_.acks.at(0).seq, next - 1) << "acknowledged when carried out";
    EXPECT_EQ(world_.find(kRed)->holder, anna_);
    EXPECT_TRUE(intake_.decisions.empty());
    ServerInput gone;  // the process has ended meanwhile: still in order
    gone.lost.push_back({UserId{}, "a", false});
    admit(std::move(gone));
  }
  ASSERT_EQ(intake_.decisions.size(), 2U);
  EXPECT_EQ(intake_.decisions[0].kind, Decision::Kind::kRelease);
  EXPECT_EQ(intake_.decisions[1].kind, Decision::Kind::kLeave);
  EXPECT_EQ(inbox_.counters().accepted, sent);
  EXPECT_EQ(inbox_.counters().longest_backlog, sent - share);
  EXPECT_EQ(inbox_.counters().liveliness_lost, 0U);
}

TEST_F(InboxTest, ABacklogKeepsTheOrderOfAUserWithTwoParts) {
  ASSERT_EQ(command("a", anna_, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  ServerInput pile;  // many of red, then one of blue: blue must not overtake
  for (std::uint64_t seq = 1; seq <= 20; ++seq) {
    pile.increments.push_back(increment("a", anna_, seq < 20 ? kRed : kBlue, seq));
  }
  admit(std::move(pile));
  std::uint64_t next = 1;
  for (int tick = 0; tick < 3; ++tick) {
    for (const Increment& taken : intake_.increments) EXPECT_EQ(taken.seq, next++);
    admit({});
  }
  EXPECT_EQ(next, 21U);
}

TEST_F(InboxTest, AReleaseAndANewGrabInOneGoKeepThePartInHand) {
  ServerInput input;
  input.increments.push_back(increment("a", anna_, kRed, 1));
  input.commands.push_back({"a", {anna_, kRed, ++command_seq_, CommandKind::kRelease}});
  input.commands.push_back({"a", {anna_, kRed, ++command_seq_, CommandKind::kGrab}});
  input.increments.push_back(increment("a", anna_, kRed, 2));
  admit(std::move(input));
  EXPECT_EQ(intake_.increments.size(), 2U);
  ServerInput more;
  more.increments.push_back(increment("a", anna_, kRed, 3));
  admit(std::move(more));
  EXPECT_EQ(intake_.decisions.size(), 2U);
  EXPECT_EQ(intake_.increments.size(), 1U);
  EXPECT_EQ(world_.find(kRed)->holder, anna_);
}

TEST_F(InboxTest, AGoodbyeInTheSameDrainAsTheClosedDoorIsAGoodbye) {
  ServerInput input;
  input.lost.push_back({UserId{}, "a", false});
  input.lost.push_back({anna_, "a", true});
  admit(std::move(input));
  EXPECT_EQ(inbox_.counters().leaves, 1U);
  EXPECT_EQ(inbox_.counters().liveliness_lost, 0U);
  EXPECT_FALSE(world_.find(anna_)->present);
}

TEST_F(InboxTest, ALeaseEndsWithoutASignOfLifeAndIsRenewedByOne) {
  now_ns_ += kSecond_ns + kSecond_ns / 2;
  ServerInput beat;
  beat.heartbeats.push_back(anna_);
  admit(std::move(beat));
  now_ns_ += kSecond_ns + kSecond_ns / 2;
  EXPECT_EQ(send(increment("a", anna_, kRed, 1)), Refusal::kNone);
  now_ns_ += 2 * kSecond_ns;
  admit({});
  EXPECT_EQ(world_.find(kRed)->holder, anna_) << "exactly at its end it still holds";
  ++now_ns_;
  admit({});
  EXPECT_FALSE(world_.find(kRed)->holder);
  ASSERT_EQ(intake_.decisions.size(), 1U);
  EXPECT_EQ(intake_.decisions[0].kind, Decision::Kind::kLeaseEnd);
  EXPECT_EQ(inbox_.counters().lease_ends, 1U);
  EXPECT_EQ(send(increment("a", anna_, kRed, 2)), Refusal::kNotHolder);
  EXPECT_EQ(command("b", ben_, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
}

TEST_F(InboxTest, ALostClientFreesAllItsPartsAndItsNameComesBackAsTheSameUser) {
  const UserId second = join("a", "anna's other hand");
  EXPECT_EQ(command("a", second, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  ServerInput input;
  input.lost.push_back({UserId{}, "a", false});
  admit(std::move(input));
  EXPECT_FALSE(world_.find(kRed)->holder);
  EXPECT_FALSE(world_.find(kBlue)->holder);
  EXPECT_EQ(inbox_.counters().liveliness_lost, 2U);
  EXPECT_EQ(inbox_.users_present(), 1U);
  EXPECT_EQ(send(increment("a", anna_, kRed, 1)), Refusal::kUnknownUser);

  EXPECT_EQ(join("a2", "anna"), anna_);
  EXPECT_EQ(command("a2", anna_, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(send(increment("a2", anna_, kRed, 1)), Refusal::kNone) << "sequences begin anew";
}

TEST_F(InboxTest, GoodbyeIsCarriedOutAfterTheLastIncrements) {
  ServerInput input;
  input.increments.push_back(increment("a", anna_, kRed, 1));
  input.lost.push_back({anna_, "a", true});
  admit(std::move(input));
  EXPECT_EQ(intake_.increments.size(), 1U);
  EXPECT_EQ(world_.find(kRed)->holder, anna_);
  admit({});
  EXPECT_FALSE(world_.find(kRed)->holder);
  EXPECT_EQ(inbox_.counters().leaves, 1U);
}

TEST_F(InboxTest, JoinsAreCheckedAndRepeatedOnesGetTheSameAnswer) {
  ServerInput again;
  again.joins.push_back({"a", 1, "anna", "designer"});
  admit(std::move(again));
  ASSERT_EQ(intake_.join_replies.size(), 1U);
  EXPECT_EQ(intake_.join_replies[0].user, anna_);
  EXPECT_TRUE(intake_.decisions.empty());

  join("c", "anna");
  EXPECT_EQ(reply_.refusal, Refusal::kNotAllowed);
  EXPECT_NE(reply_.text.find("in use"), std::string::npos);
  join("c", "");
  EXPECT_EQ(reply_.refusal, Refusal::kNotAllowed);
  for (const char* name : {"a\nb", " ", "\xc2\xa0", "J\xe4ger",
                           "an\xe2\x80\xae"
                           "na"}) {
    join("c", name);
    EXPECT_EQ(reply_.refusal, Refusal::kNotAllowed) << name;
    EXPECT_NE(reply_.text.find("printable"), std::string::npos);
  }
  EXPECT_EQ(world_.users.size(), 2U);
}

TEST(Inbox, AFullSessionSaysSo) {
  World world = small_world();
  Inbox inbox({.max_users = 1});
  Intake intake;
  ServerInput input;
  input.joins.push_back({"a", 1, "anna", "designer"});
  input.joins.push_back({"b", 1, "ben", "designer"});
  inbox.admit(std::move(input), world, 0, intake);
  ASSERT_EQ(intake.join_replies.size(), 2U);
  EXPECT_EQ(intake.join_replies[1].refusal, Refusal::kSessionFull);
  EXPECT_FALSE(intake.join_replies[1].user);
}

TEST(Inbox, OneParticipantDoesNotTakeEverySeat) {
  World world = small_world();
  Inbox inbox({.max_users = 32});
  Intake intake;
  const auto joins = [&](const ClientKey& client, std::uint64_t nonce) {
    ServerInput input;
    input.joins.push_back({client, nonce, client + std::to_string(nonce), "designer"});
    inbox.admit(std::move(input), world, 0, intake);
    return intake.join_replies.at(0);
  };
  std::uint32_t got = 0;
  for (std::uint64_t nonce = 1; nonce <= 40; ++nonce) got += bool(joins("many", nonce).user);
  EXPECT_EQ(got, 30U);
  EXPECT_EQ(joins("many", 41).refusal, Refusal::kSessionFull);
  EXPECT_TRUE(joins("many", 1).user) << "who is in, and asks again, stays";
  EXPECT_TRUE(joins("anna", 1).user);
  EXPECT_EQ(joins("anna", 2).refusal, Refusal::kSessionFull) << "she has her seat";
  EXPECT_TRUE(joins("ben", 1).user);
  EXPECT_EQ(joins("cid", 1).refusal, Refusal::kSessionFull) << "32 are 32";
  EXPECT_EQ(inbox.users_present(), 32U);
}

/// The share goes by the number of seats, is not a participant's for ever, and is nobody's loss
/// where there are few.
TEST(Inbox, TheShareOfOneParticipantIsAllSeatsButASixteenth) {
  for (const std::uint32_t max_users : {1U, 2U, 15U, 16U, 17U, 64U, 256U}) {
    SCOPED_TRACE(max_users);
    const std::uint32_t kept = max_users / 16;
    World world = small_world();
    Inbox inbox({.max_users = max_users});
    Intake intake;
    std::uint64_t nonce = 0;
    const auto gets_in = [&](const ClientKey& client) {
      ServerInput input;
      input.joins.push_back({client, ++nonce, "user " + std::to_string(nonce), "designer"});
      inbox.admit(std::move(input), world, 0, intake);
      return bool(intake.join_replies.at(0).user);
    };
    for (std::uint32_t i = 0; i < max_users - kept; ++i) ASSERT_TRUE(gets_in("many")) << i;
    EXPECT_FALSE(gets_in("many"));
    for (std::uint32_t i = 0; i < kept; ++i) {
      EXPECT_TRUE(gets_in("other " + std::to_string(i)));
      EXPECT_FALSE(gets_in("many")) << "what others have left is not its own";
    }
    EXPECT_FALSE(gets_in("late"));
    EXPECT_EQ(inbox.users_present(), max_users);
    ServerInput gone;
    gone.lost.push_back({UserId{}, "many", false});
    inbox.admit(std::move(gone), world, 0, intake);
    EXPECT_EQ(inbox.users_present(), kept);
    EXPECT_TRUE(gets_in("many")) << "it has none now";
  }
}

/// Who is told that an increment was taken, and not that it was refused, holds it for done.
TEST(Inbox, WhatIsRefusedIsAcknowledgedOnceThatIsTold) {
  World world = small_world();
  Inbox inbox({.increments_per_tick = 100});
  Intake intake;
  ServerInput input;
  input.joins.push_back({"a", 1, "anna", "designer"});
  inbox.admit(std::move(input), world, 0, intake);
  ServerInput late;  // of a part that she held before the others took her for gone
  for (std::uint64_t seq = 1; seq <= 20; ++seq)
    late.increments.push_back({"a", {UserId{1}, kRed, seq, Vec3(0.1, 0, 0), Vec3::Zero()}, 0});
  std::uint64_t told = 0;
  for (int tick = 0; tick < 4; ++tick) {
    inbox.admit(std::exchange(late, {}), world, 0, intake);
    told += intake.refused.size();
    EXPECT_TRUE(intake.acks.empty() || intake.acks.front().seq == told) << tick;
  }
  EXPECT_EQ(told, 20U);
  EXPECT_EQ(inbox.counters().refusals_untold, 0U);
}

TEST(Inbox, AFloodOfOneUserIsCutAndTheOthersGoOn) {
  World world = small_world();
  Inbox inbox({.messages_per_s = 100.0, .increments_per_tick = 1000});
  Intake intake;
  ServerInput input;
  input.joins.push_back({"a", 1, "anna", "designer"});
  input.joins.push_back({"b", 1, "ben", "designer"});
  inbox.admit(std::move(input), world, 0, intake);
  ServerInput grabs;
  grabs.commands.push_back({"a", {UserId{1}, kRed, 1, CommandKind::kGrab}});
  grabs.commands.push_back({"b", {UserId{2}, kBlue, 1, CommandKind::kGrab}});
  inbox.admit(std::move(grabs), world, 0, intake);

  ServerInput flood;
  for (std::uint64_t seq = 1; seq <= 500; ++seq) {
    flood.increments.push_back({"a", {UserId{1}, kRed, seq, Vec3(0.1, 0, 0), Vec3::Zero()}, 0});
  }
  flood.increments.push_back({"b", {UserId{2}, kBlue, 1, Vec3(1, 0, 0), Vec3::Zero()}, 0});
  inbox.admit(std::move(flood), world, 0, intake);
  EXPECT_EQ(intake.increments.size(), 99U + 1U);  // the grab took one of Anna's hundred
  EXPECT_EQ(intake.increments.back().user, UserId{2});
  EXPECT_EQ(inbox.counters().refused[static_cast<std::size_t>(Refusal::kRateTooHigh)], 401U);
  EXPECT_EQ(intake.refused.size(), InboxLimits{}.refusals_told_per_tick);
  EXPECT_EQ(inbox.counters().refusals_untold, 401U - InboxLimits{}.refusals_told_per_tick);
  EXPECT_EQ(intake.acks.front().seq, 500U);

  ServerInput later;  // a tenth of a second fills ten tokens
  for (std::uint64_t seq = 501; seq <= 520; ++seq) {
    later.increments.push_back({"a", {UserId{1}, kRed, seq, Vec3(0.1, 0, 0), Vec3::Zero()}, 0});
  }
  inbox.admit(std::move(later), world, kSecond_ns / 10, intake);
  EXPECT_EQ(intake.increments.size(), 10U);
}

}  // namespace
}  // namespace mortise
