#include <gtest/gtest.h>

#include <array>

#include "server/inbox.h"
#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;

class InboxLimitsTest : public ::testing::Test {
 protected:
  UserId join(const std::string& name) {
    ServerInput input;
    input.joins.push_back({name, 1, name, "designer"});
    inbox().admit(std::move(input), world_, now_ns_, intake_);
    return intake_.join_replies.at(0).user;
  }
  Reply command(const std::string& client, UserId user, PartId part, CommandKind kind) {
    ServerInput input;
    input.commands.push_back({client, Command{user, part, ++seq_, kind}});
    inbox().admit(std::move(input), world_, now_ns_, intake_);
    return intake_.replies.at(0);
  }
  std::size_t accepted_of(const std::string& client, UserId user, int count) {
    ServerInput input;
    for (int i = 0; i < count; ++i)
      input.increments.push_back({client, {user, kRed, ++seq_, {0.01, 0, 0}, Vec3::Zero()}, 0});
    const std::uint64_t before = inbox().counters().accepted;
    inbox().admit(std::move(input), world_, now_ns_, intake_);
    return inbox().counters().accepted - before + inbox().waiting_increments();
  }
  /// Anna holds the red part, Cid the blue one, and Ben, who may hold one, asks for both.
  std::array<UserId, 3> ben_asks_for_both() {
    limits_.parts_per_user = 1;
    const UserId anna = join("anna"), ben = join("ben"), cid = join("cid");
    EXPECT_EQ(command("anna", anna, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
    EXPECT_EQ(command("cid", cid, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
    EXPECT_EQ(command("ben", ben, kRed, CommandKind::kAskHandOver).refusal, Refusal::kNone);
    EXPECT_EQ(command("ben", ben, kBlue, CommandKind::kAskHandOver).refusal, Refusal::kNone);
    return {anna, ben, cid};
  }
  Inbox& inbox() {
    if (!inbox_) inbox_ = std::make_unique<Inbox>(limits_);
    return *inbox_;
  }

  InboxLimits limits_;
  World world_ = small_world();
  std::unique_ptr<Inbox> inbox_;
  Intake intake_;
  std::int64_t now_ns_ = kSecond_ns;
  std::uint64_t seq_ = 0;
};

TEST_F(InboxLimitsTest, NewcomersArePutOffAndWhoIsHereIsAnswered) {
  const UserId anna = join("anna"), ben = join("ben");
  inbox().put_off_newcomers();
  EXPECT_EQ(join("anna"), anna) << "asked again, as one does who has heard nothing";
  ServerInput input;
  input.joins.push_back({"cid", 1, "cid", "designer"});
  input.joins.push_back({"ben", 2, "benno", "designer"});
  input.lost.push_back({ben, "ben", false});
  inbox().admit(std::move(input), world_, now_ns_, intake_);
  EXPECT_TRUE(intake_.join_replies.empty()) << "neither in nor refused: they ask again";
  EXPECT_EQ(inbox().counters().joins_put_off, 2u);
  EXPECT_EQ(inbox().counters().joins_refused, 0u);
  EXPECT_EQ(inbox().users_present(), 1u);
}

TEST_F(InboxLimitsTest, AHandHoldsSoManyPartsAndNoMore) {
  limits_.parts_per_user = 1;
  const UserId anna = join("anna"), ben = join("ben");
  EXPECT_EQ(command("anna", anna, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  const Reply second = command("anna", anna, kBlue, CommandKind::kGrab);
  EXPECT_EQ(second.refusal, Refusal::kNotAllowed);
  EXPECT_NE(second.text.find("at most 1"), std::string::npos) << second.text;
  EXPECT_EQ(command("anna", anna, kRed, CommandKind::kGrab).refusal, Refusal::kNone) << "has it";
  EXPECT_EQ(command("ben", ben, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(command("ben", ben, kBlue, CommandKind::kRelease).refusal, Refusal::kNone);
  EXPECT_EQ(command("anna", anna, kRed, CommandKind::kRelease).refusal, Refusal::kNone);
  EXPECT_EQ(command("anna", anna, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(inbox().user_counters()[0].commands, 5U);
  EXPECT_EQ(inbox().user_counters()[0].commands_refused, 1U);
}

// Two asks may stand while the hand is empty; the second consent would fill it beyond the limit.
TEST_F(InboxLimitsTest, WhatIsHandedOverCountsAsWell) {
  const auto [anna, ben, cid] = ben_asks_for_both();
  EXPECT_EQ(command("anna", anna, kRed, CommandKind::kConsent).refusal, Refusal::kNone);
  EXPECT_EQ(command("cid", cid, kBlue, CommandKind::kConsent).refusal, Refusal::kNotAllowed);
  EXPECT_EQ(world_.find(kBlue)->holder, cid);
}

// Both consents wait for the end of a drag, and are carried out in the same tick.
TEST_F(InboxLimitsTest, WhatIsHandedOverTogetherCountsTogether) {
  const auto [anna, ben, cid] = ben_asks_for_both();
  ServerInput input;
  for (int i = 0; i < 9; ++i) {  // one more than a tick takes
    input.increments.push_back({"anna", {anna, kRed, ++seq_, {0.01, 0, 0}, Vec3::Zero()}, 0});
    input.increments.push_back({"cid", {cid, kBlue, ++seq_, {0.01, 0, 0}, Vec3::Zero()}, 0});
  }
  input.commands.push_back({"anna", {anna, kRed, ++seq_, CommandKind::kConsent}});
  input.commands.push_back({"cid", {cid, kBlue, ++seq_, CommandKind::kConsent}});
  inbox().admit(std::move(input), world_, now_ns_, intake_);
  ASSERT_EQ(inbox().waiting_commands(), 2U);
  for (int i = 0; i < 3; ++i) {
    inbox().admit({}, world_, now_ns_, intake_);
    if (!intake_.replies.empty()) break;
  }
  ASSERT_EQ(intake_.replies.size(), 2U);
  EXPECT_EQ(intake_.replies[0].refusal, Refusal::kNone);
  EXPECT_EQ(intake_.replies[1].refusal, Refusal::kNotAllowed);
  EXPECT_EQ(intake_.replies[1].holder, cid);
  EXPECT_EQ(world_.find(kRed)->holder, ben);
  EXPECT_EQ(world_.find(kBlue)->holder, cid);
}

// Each below the limit of one user, together above that of the session.
TEST_F(InboxLimitsTest, ASessionTakesSoManyMessagesOfAllTogether) {
  limits_.messages_per_s = 100.0;
  limits_.session_messages_per_s = 120.0;
  limits_.increments_per_tick = 1000;
  const UserId anna = join("anna");
  ASSERT_EQ(command("anna", anna, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(accepted_of("anna", anna, 90), 90U);
  const UserId ben = join("ben");
  for (int i = 0; i < 40; ++i) command("ben", ben, kBlue, CommandKind::kGrab);
  EXPECT_EQ(inbox().user_counters()[1].commands_refused, 40U - 29U) << "120 - 1 - 90 were left";
  now_ns_ += kSecond_ns / 2;  // 60 more for all
  EXPECT_EQ(command("ben", ben, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(accepted_of("anna", anna, 70), 50U + 9U)
      << "60 - 1 of the session, and 9 + 50 of her own";
}

}  // namespace
}  // namespace mortise
