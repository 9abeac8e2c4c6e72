// Roles, presence and hand-over at the door.
#include <gtest/gtest.h>

#include "tests/unit/server/inbox_bench.h"

namespace mortise {
namespace {

using namespace mortise::testing;

class InboxPeopleTest : public InboxTest {};

TEST_F(InboxPeopleTest, ObserversLookOnly) {
  const UserId eve = join("e", "eve", "observer");
  EXPECT_EQ(world_.find(eve)->role, Role::kObserver);
  EXPECT_EQ(command("e", eve, kBlue, CommandKind::kGrab).refusal, Refusal::kObserver);
  EXPECT_FALSE(world_.find(kBlue)->holder);
  EXPECT_EQ(send(increment("e", eve, kBlue, 1)), Refusal::kObserver);
  EXPECT_EQ(command("e", eve, kRed, CommandKind::kAskHandOver).refusal, Refusal::kObserver);
}

TEST_F(InboxPeopleTest, RolesAreThoseThatTheScenarioWants) {
  world_.may_hold = {{"eve", {}, {}, std::nullopt, Role::kObserver}, {"*", {"*"}, {}}};
  join("e", "eve", "designer");
  EXPECT_EQ(reply_.refusal, Refusal::kNotAllowed);
  EXPECT_NE(reply_.text.find("observer"), std::string::npos) << reply_.text;
  EXPECT_TRUE(join("e", "eve", "observer"));
  join("f", "finn", "emperor");
  EXPECT_EQ(reply_.refusal, Refusal::kNotAllowed);
}

TEST_F(InboxPeopleTest, WhoComesBackMayHaveAnotherRole) {
  ServerInput input;
  input.lost.push_back({ben_, "b", true});
  admit(std::move(input));
  EXPECT_FALSE(world_.find(ben_)->present);
  EXPECT_EQ(join("b2", "ben", "observer"), ben_);
  EXPECT_EQ(world_.find(ben_)->role, Role::kObserver);
  EXPECT_EQ(intake_.decisions.at(0).role, Role::kObserver);
}

TEST_F(InboxPeopleTest, AnAskStaysUntilItIsAnsweredOrWithdrawn) {
  EXPECT_EQ(command("b", ben_, kRed, CommandKind::kAskHandOver).refusal, Refusal::kNone);
  ASSERT_EQ(intake_.decisions.size(), 1U);
  EXPECT_EQ(intake_.decisions[0].kind, Decision::Kind::kAskHandOver);
  EXPECT_EQ(intake_.decisions[0].details.other_user, anna_);
  for (int i = 0; i < 20; ++i) {  // the lease is 2 s
    now_ns_ += kSecond_ns;
    ServerInput input;
    input.heartbeats = {anna_, ben_};
    admit(std::move(input));
    EXPECT_TRUE(intake_.decisions.empty());
  }
  EXPECT_EQ(world_.find(kRed)->asked_by, ben_);
  EXPECT_EQ(command("a", anna_, kRed, CommandKind::kWithdraw).refusal, Refusal::kNotAsked);
  EXPECT_EQ(command("b", ben_, kRed, CommandKind::kWithdraw).refusal, Refusal::kNone);
  ASSERT_EQ(intake_.decisions.size(), 1U);
  EXPECT_EQ(intake_.decisions[0].kind, Decision::Kind::kAskEnd);
  EXPECT_EQ(intake_.decisions[0].user, ben_);
  EXPECT_EQ(intake_.decisions[0].details.other_user, anna_);
  EXPECT_FALSE(world_.find(kRed)->asked_by);
  EXPECT_EQ(world_.find(kRed)->holder, anna_);
}

TEST_F(InboxPeopleTest, AHandOverBeginsALeaseOfItsOwn) {
  command("b", ben_, kRed, CommandKind::kAskHandOver);
  now_ns_ += kSecond_ns * 19 / 10;
  EXPECT_EQ(command("a", anna_, kRed, CommandKind::kConsent).refusal, Refusal::kNone);
  EXPECT_EQ(world_.find(kRed)->holder, ben_);
  now_ns_ += kSecond_ns * 19 / 10;
  admit({});
  EXPECT_EQ(world_.find(kRed)->holder, ben_);
  EXPECT_EQ(send(increment("b", ben_, kRed, 1)), Refusal::kNone);
}

TEST_F(InboxPeopleTest, ConsentWaitsForTheEndOfTheDrag) {
  command("b", ben_, kRed, CommandKind::kAskHandOver);
  ServerInput input;
  for (std::uint64_t seq = 1; seq <= 20; ++seq)
    input.increments.push_back(increment("a", anna_, kRed, seq));
  Details details;
  details.parts = {kRed};
  input.commands.push_back({"a", {anna_, kRed, ++command_seq_, CommandKind::kConsent}});
  input.commands.push_back(
      {"a", {anna_, PartId{}, ++command_seq_, CommandKind::kRelease, details}});
  std::size_t applied = 0;
  admit(std::move(input));
  while (world_.find(kRed)->holder == anna_) {
    applied += intake_.increments.size();
    ASSERT_LE(applied, 20U);
    admit({});
  }
  EXPECT_EQ(applied, 20U);
  EXPECT_EQ(world_.find(kRed)->holder, ben_);
  ASSERT_EQ(intake_.replies.size(), 2U);  // in the order in which they were sent
  EXPECT_EQ(intake_.replies[0].refusal, Refusal::kNone);
  EXPECT_EQ(intake_.replies[1].refusal, Refusal::kNotHolder);
}

}  // namespace
}  // namespace mortise
