#include "common/session/world/world.h"

#include <gtest/gtest.h>

#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

struct WorldTest : ::testing::Test {
  SessionBuilder session;
  PartId wall = session.add("wall", cube_mesh(1), at(100, 0, 0), false);
  PartId peg = session.add("peg-1", cube_mesh(1), at(0, 0, 0), true);
  PartId pin = session.add("pin", cube_mesh(1), at(0, 50, 0), true);
  UserId ada = session.join("ada");
  UserId bob = session.join("bob");
  Scratch scratch;

  Refusal refusal(UserId user, PartId part, CommandKind kind) {
    return session.command(user, part, kind).refusal;
  }
  void move(UserId user, PartId part, const Vec3& by) {
    const StepReport report = play_tick(session.world, {session.push(user, part, by)}, scratch);
    ASSERT_TRUE(report.refused.empty());
  }
};

TEST_F(WorldTest, UsersAreNumberedInTheOrderOfJoining) {
  EXPECT_EQ(ada.value, 1U);
  EXPECT_EQ(bob.value, 2U);
  EXPECT_TRUE(session.world.find(bob)->present);
}

TEST_F(WorldTest, GrabIsRefusedWithTheHoldersName) {
  EXPECT_EQ(session.grab(ada, peg).refusal, Refusal::kNone);
  const Reply reply = session.grab(bob, peg);
  EXPECT_EQ(reply.refusal, Refusal::kHeldByOther);
  EXPECT_EQ(reply.holder, ada);
  EXPECT_NE(reply.text.find("'ada'"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("'peg-1'"), std::string::npos) << reply.text;
  EXPECT_EQ(session.world.find(peg)->holder, ada);
}

TEST_F(WorldTest, EveryRefusalOfACommandHasAReasonInWords) {
  EXPECT_EQ(refusal(UserId{9}, peg, CommandKind::kGrab), Refusal::kUnknownUser);
  EXPECT_EQ(refusal(UserId{}, peg, CommandKind::kGrab), Refusal::kUnknownUser);
  EXPECT_EQ(refusal(ada, PartId{9}, CommandKind::kGrab), Refusal::kUnknownPart);
  EXPECT_EQ(refusal(ada, PartId{}, CommandKind::kGrab), Refusal::kUnknownPart);
  EXPECT_EQ(refusal(ada, wall, CommandKind::kGrab), Refusal::kPartIsStatic);
  EXPECT_EQ(refusal(ada, peg, CommandKind::kRelease), Refusal::kNotHolder);
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kNothingToUndo);
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUnknown), Refusal::kNotAllowed);
  session.grab(ada, peg);
  EXPECT_EQ(refusal(bob, peg, CommandKind::kRelease), Refusal::kNotHolder);
  EXPECT_EQ(refusal(bob, peg, CommandKind::kReset), Refusal::kHeldByOther);
  EXPECT_FALSE(session.command(bob, peg, CommandKind::kReset).text.empty());
}

TEST_F(WorldTest, RefusedCommandLeavesNoDecisionAndNoTrace) {
  Decision decision;
  apply_command(session.world, Command{ada, wall, 3, CommandKind::kGrab}, decision);
  EXPECT_EQ(decision.kind, Decision::Kind::kUnknown);
  EXPECT_FALSE(session.world.find(wall)->holder);
}

TEST_F(WorldTest, MayHoldUnderstandsWildcards) {
  session.world.may_hold = {{"ada", {"peg-*"}, {}}, {"bot-*", {"*"}, {}}};
  const UserId bot = session.join("bot-7");
  EXPECT_EQ(refusal(ada, peg, CommandKind::kGrab), Refusal::kNone);
  EXPECT_EQ(refusal(ada, pin, CommandKind::kGrab), Refusal::kNotAllowed);
  EXPECT_EQ(refusal(bob, pin, CommandKind::kGrab), Refusal::kNotAllowed);
  EXPECT_EQ(refusal(bot, pin, CommandKind::kGrab), Refusal::kNone);
}

TEST_F(WorldTest, LeaveFreesPartsAndALeaseEndOnlyItsOwn) {
  session.grab(ada, peg);
  session.grab(ada, pin);
  Decision lease;
  lease.kind = Decision::Kind::kLeaseEnd;
  lease.user = ada;
  lease.part = peg;
  EXPECT_EQ(apply_decision(session.world, lease).size(), 1U);
  EXPECT_FALSE(session.world.find(peg)->holder);
  EXPECT_EQ(session.world.find(pin)->holder, ada);
  Decision lost;
  lost.kind = Decision::Kind::kLivelinessLost;
  lost.user = ada;
  const auto freed = apply_decision(session.world, lost);
  ASSERT_EQ(freed.size(), 1U);
  EXPECT_EQ(freed[0].part, pin);
  EXPECT_FALSE(session.world.find(ada)->present);
  EXPECT_EQ(refusal(ada, pin, CommandKind::kGrab), Refusal::kUnknownUser);
}

TEST_F(WorldTest, JoinWithTheIdOfAnAbsentUserBringsItBack) {
  Decision leave;
  leave.kind = Decision::Kind::kLeave;
  leave.user = ada;
  apply_decision(session.world, leave);
  Decision join;
  join.kind = Decision::Kind::kJoin;
  join.user = ada;
  apply_decision(session.world, join);
  EXPECT_EQ(session.world.users.size(), 2U);
  EXPECT_TRUE(session.world.find(ada)->present);
  EXPECT_EQ(session.world.find(ada)->name, "ada");
}

TEST_F(WorldTest, UndoGoesBackToWhereTheGrabBegan) {
  session.grab(ada, peg);
  move(ada, peg, Vec3(1, 0, 0));
  move(ada, peg, Vec3(2, 0, 0));
  EXPECT_EQ(session.pose(peg).p, Vec3(3, 0, 0));
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 0));
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kNothingToUndo);
  move(ada, peg, Vec3(5, 0, 0));  // the same grab, after the undo
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 0));
}

TEST_F(WorldTest, UndoIsOnlyForTheOneWhoMovedLast) {
  session.grab(ada, peg);
  move(ada, peg, Vec3(1, 0, 0));
  session.command(ada, peg, CommandKind::kRelease);
  session.grab(bob, peg);
  // A grab alone moves nothing: it is in the way only while it lasts.
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kHeldByOther);
  move(bob, peg, Vec3(1, 0, 0));
  const Reply reply = session.command(ada, peg, CommandKind::kUndo);
  EXPECT_EQ(reply.refusal, Refusal::kMovedBySomeoneElse);
  EXPECT_NE(reply.text.find("'bob'"), std::string::npos) << reply.text;
  session.command(bob, peg, CommandKind::kRelease);
  EXPECT_EQ(refusal(bob, peg, CommandKind::kUndo), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(1, 0, 0));
}

TEST_F(WorldTest, ResetGoesHomeAndCanBeUndone) {
  session.grab(ada, peg);
  move(ada, peg, Vec3(0, 0, 7));
  EXPECT_EQ(refusal(ada, peg, CommandKind::kReset), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 0));
  EXPECT_EQ(refusal(ada, peg, CommandKind::kUndo), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 7));
}

// A replay applies decisions only; it must end where the commands led.
TEST_F(WorldTest, DecisionsReplayToTheSameState) {
  SessionBuilder again;
  again.add("wall", cube_mesh(1), at(100, 0, 0), false);
  again.add("peg-1", cube_mesh(1), at(0, 0, 0), true);
  again.add("pin", cube_mesh(1), at(0, 50, 0), true);
  again.join("ada");
  again.join("bob");
  Scratch other;
  const auto both = [&](CommandKind kind) {
    Decision decision;
    ASSERT_EQ(apply_command(session.world, Command{ada, peg, 1, kind}, decision).refusal,
              Refusal::kNone);
    apply_decision(again.world, decision);
  };
  const auto both_step = [&](const std::vector<Increment>& increments) {
    EXPECT_EQ(play_tick(session.world, increments, scratch).state_hash,
              play_tick(again.world, increments, other).state_hash);
  };
  both(CommandKind::kGrab);
  both_step({session.push(ada, peg, Vec3(1, 2, 3))});
  both(CommandKind::kUndo);
  both_step({});
  both_step({session.push(ada, peg, Vec3(3, 2, 1), Vec3(0, 0, 0.1))});
  both(CommandKind::kReset);
  both_step({});
  both(CommandKind::kRelease);
  both_step({});
}

TEST_F(WorldTest, SnapshotNamesEverything) {
  session.grab(bob, pin);
  play_tick(session.world, {}, scratch);
  session.world.parts[1].notes = {"was turned"};
  const Snapshot snapshot = snapshot_of(session.world);
  ASSERT_EQ(snapshot.notes.size(), 1U);
  EXPECT_EQ(snapshot.notes[0].part, PartId{2});
  ASSERT_EQ(snapshot.parts.size(), 3U);
  EXPECT_EQ(snapshot.parts[2].holder, bob);
  EXPECT_EQ(snapshot.parts[2].name, "pin");
  EXPECT_EQ(snapshot.parts[1].mesh_hash, snapshot.parts[2].mesh_hash);
  EXPECT_EQ(snapshot.users.size(), 2U);
  EXPECT_EQ(snapshot.tick, 1U);
  EXPECT_EQ(snapshot.policy, "report");
}

}  // namespace
}  // namespace mortise
