// What people may do to each other's parts and to the rules of a session, and what a replay makes
// of it.
#include <gtest/gtest.h>

#include "common/session/memory/session_state.h"
#include "tests/unit/session/three_people.h"

namespace mortise {
namespace {

// 1. roles and rights

TEST_F(PeopleTest, AnObserverLooksOnly) {
  for (std::uint8_t kind = 1; kind < kCommandKindCount; ++kind) {
    const Reply reply = ask(eve, static_cast<CommandKind>(kind), peg, with_other(wall, "stop"));
    EXPECT_EQ(reply.refusal, Refusal::kObserver) << int{kind};
    EXPECT_NE(reply.text.find("'eve'"), std::string::npos);
  }
}

TEST_F(PeopleTest, WithoutUsersInTheScenarioDesignersChangeRulesAndBotsDoNot) {
  const UserId bot = session.join("bot", Role::kBot);
  twin.join("bot", Role::kBot);
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, PartId{}, with_text("stop")), Refusal::kNone);
  EXPECT_EQ(refusal(bot, CommandKind::kSetPolicy, PartId{}, with_text("stop")), Refusal::kNoRight);
  EXPECT_EQ(refusal(bot, CommandKind::kSetExclusion, peg, with_other(wall, "x")),
            Refusal::kNoRight);
  EXPECT_EQ(refusal(bot, CommandKind::kGrab, peg), Refusal::kNone);
}

TEST_F(PeopleTest, RightsComeFromTheScenario) {
  session.world.may_hold = {{"ada", {"peg"}, {}, std::vector<Right>{Right::kPolicy}},
                            {"bob", {"*"}, {}}};
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, PartId{}, with_text("stop")), Refusal::kNone);
  EXPECT_EQ(refusal(bob, CommandKind::kSetPolicy, PartId{}, with_text("stop")), Refusal::kNoRight);
  EXPECT_EQ(refusal(ada, CommandKind::kSetExclusion, peg, with_other(wall, "x")),
            Refusal::kNoRight);
  const ClashEvent event = clash();
  EXPECT_EQ(refusal(ada, CommandKind::kReview, {}, review_of(event, ReviewStatus::kReviewed)),
            Refusal::kNoRight);
  EXPECT_EQ(refusal(bob, CommandKind::kReview, {}, review_of(event, ReviewStatus::kReviewed)),
            Refusal::kNone);
}

// 2. hand-over

TEST_F(PeopleTest, APartIsHandedOverByConsent) {
  EXPECT_EQ(refusal(bob, CommandKind::kAskHandOver, peg), Refusal::kNotHeld);
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(1, 0, 0));
  EXPECT_EQ(refusal(ada, CommandKind::kConsent, peg), Refusal::kNotAsked);
  EXPECT_EQ(refusal(bob, CommandKind::kAskHandOver, peg), Refusal::kNone);
  EXPECT_EQ(session.world.find(peg)->holder, ada);
  ASSERT_EQ(snapshot_of(session.world).standing.size(), 1U);
  EXPECT_EQ(refusal(bob, CommandKind::kConsent, peg), Refusal::kNotHolder);
  EXPECT_EQ(refusal(ada, CommandKind::kConsent, peg), Refusal::kNone);
  EXPECT_EQ(session.world.find(peg)->holder, bob);
  EXPECT_FALSE(session.world.find(peg)->asked_by);
  tick();
}

TEST_F(PeopleTest, WhoIsDeclinedDoesNotGetIt) {
  const UserId cid = session.join("cid");
  twin.join("cid");
  ask(ada, CommandKind::kGrab, peg);
  ask(bob, CommandKind::kAskHandOver, peg);
  const Reply second = ask(cid, CommandKind::kAskHandOver, peg);
  EXPECT_EQ(second.refusal, Refusal::kAlreadyAsked);
  EXPECT_NE(second.text.find("'bob'"), std::string::npos);
  EXPECT_EQ(refusal(ada, CommandKind::kDecline, peg, with_text("not yet")), Refusal::kNone);
  EXPECT_EQ(session.world.find(peg)->holder, ada);
  EXPECT_EQ(refusal(cid, CommandKind::kAskHandOver, peg), Refusal::kNone);
  ask(ada, CommandKind::kRelease, peg);  // the ask is over with the hold
  EXPECT_FALSE(session.world.find(peg)->asked_by);
}

// 3. undo and redo

TEST_F(PeopleTest, MovesAreTakenBackOneByOneAndRepeated) {
  for (int i = 1; i <= 3; ++i) {
    ask(ada, CommandKind::kGrab, peg);
    move(ada, peg, Vec3(0, 0, 1));
    move(ada, peg, Vec3(0, 0, 1));
    ask(ada, CommandKind::kRelease, peg);
  }
  for (int i = 2; i >= 0; --i) {
    EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg), Refusal::kNone);
    EXPECT_EQ(session.pose(peg).p.z(), 2.0 * i);
    tick();
  }
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg), Refusal::kNothingToUndo);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(refusal(ada, CommandKind::kRedo, peg), Refusal::kNone);
    EXPECT_EQ(session.pose(peg).p.z(), 2.0 * i);
    tick();
  }
  EXPECT_EQ(refusal(ada, CommandKind::kRedo, peg), Refusal::kNothingToRedo);
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg), Refusal::kNone);
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(1, 0, 0));  // another way: the old one is forgotten
  EXPECT_EQ(refusal(ada, CommandKind::kRedo, peg), Refusal::kNothingToRedo);
}

TEST_F(PeopleTest, RedoIsRefusedAfterAForeignMoveAndPossibleOnceThatIsTakenBack) {
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(0, 0, 1));
  ask(ada, CommandKind::kUndo, peg);
  ask(ada, CommandKind::kRelease, peg);
  ask(bob, CommandKind::kGrab, peg);
  move(bob, peg, Vec3(0, 3, 0));
  ask(bob, CommandKind::kRelease, peg);
  const Reply reply = ask(ada, CommandKind::kRedo, peg);
  EXPECT_EQ(reply.refusal, Refusal::kMovedBySomeoneElse);
  EXPECT_NE(reply.text.find("'bob'"), std::string::npos) << reply.text;
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 3, 0));
  EXPECT_EQ(refusal(bob, CommandKind::kUndo, peg), Refusal::kNone);
  EXPECT_EQ(refusal(ada, CommandKind::kRedo, peg), Refusal::kNone);
  EXPECT_EQ(session.pose(peg).p, Vec3(0, 0, 1));
  tick();
}

TEST(MoveHistory, ForgetsTheOldestAndStaysBounded) {
  MoveHistory history;
  for (int i = 0; i < 1000; ++i) {
    history.end_move();
    history.note(UserId{1}, at(i, 0, 0));
  }
  ASSERT_EQ(history.done.size(), 64U);
  Pose X_WP = at(1000, 0, 0);
  for (int i = 999; i >= 1000 - 64; --i) {
    ASSERT_EQ(history.may_undo(UserId{1}).refusal, Refusal::kNone);
    X_WP = history.undo(X_WP);
    ASSERT_EQ(X_WP.p.x(), i);
  }
  EXPECT_EQ(history.may_undo(UserId{1}).refusal, Refusal::kNothingToUndo);
  EXPECT_EQ(history.undone.size(), 64U);
}

// 4. groups

TEST_F(PeopleTest, AGroupIsGrabbedWholeOrNotAtAll) {
  ask(bob, CommandKind::kGrab, pin);
  const Reply reply = ask(ada, CommandKind::kGrab, {}, with_parts({peg, pin}));
  EXPECT_EQ(reply.refusal, Refusal::kHeldByOther);
  EXPECT_NE(reply.text.find("'bob'"), std::string::npos);
  EXPECT_FALSE(session.world.find(peg)->holder);
  ask(bob, CommandKind::kRelease, pin);
  EXPECT_EQ(refusal(ada, CommandKind::kGrab, {}, with_parts({peg, pin, peg})), Refusal::kBadGroup);
  EXPECT_EQ(refusal(ada, CommandKind::kGrab, {}, with_parts({peg, wall})), Refusal::kPartIsStatic);
  EXPECT_EQ(refusal(ada, CommandKind::kGrab, {}, with_parts({peg, pin})), Refusal::kNone);
  EXPECT_EQ(session.world.find(peg)->holder, ada);
  EXPECT_EQ(session.world.find(pin)->holder, ada);
  EXPECT_TRUE(session.world.find(pin)->group);
  EXPECT_EQ(session.world.find(pin)->group, session.world.find(peg)->group);
  EXPECT_EQ(refusal(bob, CommandKind::kRelease, {}, with_parts({peg, pin})), Refusal::kNotHolder);
  EXPECT_EQ(refusal(ada, CommandKind::kRelease, {}, with_parts({peg, pin})), Refusal::kNone);
  EXPECT_FALSE(session.world.find(pin)->group);
}

// 5. rules of the session

TEST_F(PeopleTest, PolicyChangesInMidSession) {
  clash();  // policy report: 1 mm deep
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, {}, with_text("glue")), Refusal::kBadRule);
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, {}, with_text("stop")), Refusal::kNone);
  EXPECT_EQ(snapshot_of(session.world).policy, "stop");
  EXPECT_EQ(snapshot_of(session.world).standing.size(), 1U);
  move(ada, peg, Vec3(1, 0, 0));
  EXPECT_NEAR(session.pose(peg).p.x(), 15.0, 0.02);  // no deeper
  move(ada, peg, Vec3(-3, 0, 0));
  EXPECT_NEAR(session.pose(peg).p.x(), 12.0, 0.02);  // but out of it
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, {}, with_text("report")), Refusal::kNone);
  move(ada, peg, Vec3(5, 0, 0));
  EXPECT_NEAR(session.pose(peg).p.x(), 17.0, 0.02);
  // Deeper than it ever was under stop: from here on stop lets it go no deeper, but out.
  EXPECT_EQ(refusal(ada, CommandKind::kSetPolicy, {}, with_text("stop")), Refusal::kNone);
  EXPECT_EQ(snapshot_of(session.world).standing.size(), 1U);
  move(ada, peg, Vec3(-4, 0, 0));
  EXPECT_NEAR(session.pose(peg).p.x(), 13.0, 0.02);
}

TEST_F(PeopleTest, AnExclusionEndsTheClashAndItsEndBringsItBack) {
  const ClashEvent begin = clash();
  EXPECT_EQ(refusal(bob, CommandKind::kSetExclusion, wall, with_other(peg, "")), Refusal::kBadRule);
  EXPECT_EQ(refusal(bob, CommandKind::kSetExclusion, wall, with_other(wall, "x")),
            Refusal::kBadRule);
  EXPECT_EQ(refusal(bob, CommandKind::kDropExclusion, wall, with_other(peg, "")),
            Refusal::kBadRule);
  EXPECT_EQ(refusal(bob, CommandKind::kSetExclusion, wall, with_other(peg, "glued")),
            Refusal::kNone);
  const StepReport without = tick();
  ASSERT_EQ(without.events.size(), 1U);
  EXPECT_EQ(without.events[0].kind, ClashEvent::Kind::kEnd);
  EXPECT_EQ(without.events[0].clash, begin.clash);
  EXPECT_EQ(without.events[0].cause, Decision::Kind::kSetExclusion);
  EXPECT_EQ(without.events[0].user, bob);
  EXPECT_EQ(session.world.rule(peg, wall)->reason, "glued");
  EXPECT_EQ(refusal(bob, CommandKind::kDropExclusion, peg, with_other(wall, "")), Refusal::kNone);
  const StepReport with = tick();
  ASSERT_EQ(with.events.size(), 1U);
  EXPECT_EQ(with.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(with.events[0].cause, Decision::Kind::kDropExclusion);
  EXPECT_TRUE(tick().events.empty());
}

// 6. reviews

TEST_F(PeopleTest, AReviewIsToldAndStandsApartFromTheClass) {
  const ClashEvent event = clash();
  EXPECT_EQ(event.review.status, ReviewStatus::kNew);
  EXPECT_EQ(refusal(bob, CommandKind::kReview, {}, review_of(event, ReviewStatus::kApproved, "ok")),
            Refusal::kNone);
  const StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  const ClashEvent& told = report.events[0];
  EXPECT_EQ(told.kind, ClashEvent::Kind::kReview);
  EXPECT_EQ(told.seq, event.seq + 1);
  EXPECT_EQ(told.user, bob);
  EXPECT_EQ(told.review.status, ReviewStatus::kApproved);
  EXPECT_EQ(told.review.comment, "ok");
  EXPECT_EQ(told.review.tick, report.tick);
  EXPECT_EQ(told.verdict.collision_class, event.verdict.collision_class);
  const Snapshot snapshot = snapshot_of(session.world);
  ASSERT_EQ(snapshot.open_clashes.size(), 1U);
  EXPECT_EQ(snapshot.open_clashes[0].review.status, ReviewStatus::kApproved);
  ClashEvent unknown = event;
  unknown.clash = ClashId{99};
  EXPECT_EQ(refusal(bob, CommandKind::kReview, {}, review_of(unknown, ReviewStatus::kReviewed)),
            Refusal::kUnknownClash);
}

TEST_F(PeopleTest, AWorsenedClashLosesItsApproval) {
  const ClashEvent event = clash();
  ask(bob, CommandKind::kReview, {}, review_of(event, ReviewStatus::kApproved, "press fit"));
  move(ada, peg, Vec3(-0.5, 0, 0));  // better
  EXPECT_EQ(snapshot_of(session.world).open_clashes[0].review.status, ReviewStatus::kApproved);
  const StepReport worse = move(ada, peg, Vec3(0.6, 0, 0));
  ASSERT_EQ(worse.events.size(), 1U);
  EXPECT_TRUE(worse.events[0].approval_lost);
  EXPECT_EQ(worse.events[0].review.status, ReviewStatus::kActive);
  EXPECT_FALSE(worse.events[0].review.user);
  EXPECT_NE(worse.events[0].review.comment.find("no longer approved"), std::string::npos);
  EXPECT_NE(worse.events[0].review.comment.find("press fit"), std::string::npos);
  for (const ClashEvent& later : move(ada, peg, Vec3(0.1, 0, 0)).events)
    EXPECT_FALSE(later.approval_lost);
}

TEST_F(PeopleTest, OtherStatusesAreNotTakenBack) {
  const ClashEvent event = clash();
  ask(bob, CommandKind::kReview, {}, review_of(event, ReviewStatus::kReviewed));
  for (const ClashEvent& later : move(ada, peg, Vec3(0.6, 0, 0)).events)
    EXPECT_FALSE(later.kind == ClashEvent::Kind::kChange && later.approval_lost);
  EXPECT_EQ(snapshot_of(session.world).open_clashes[0].review.status, ReviewStatus::kReviewed);
}

// One part is asked for and checked; a list beside it must not be what is carried out.
TEST_F(PeopleTest, AListOfPartsIsForThoseWhoCheckIt) {
  ask(bob, CommandKind::kGrab, pin);
  move(bob, pin, Vec3(0, 0, 3));
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(0, 0, 1));
  ask(bob, CommandKind::kAskHandOver, peg);
  const Details others = with_parts({pin, PartId{99}});
  for (std::uint8_t k = 1; k < kCommandKindCount; ++k) {
    const auto kind = static_cast<CommandKind>(k);
    EXPECT_NE(refusal(ada, kind, peg, others), Refusal::kNone) << static_cast<int>(k);
  }
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg, others), Refusal::kBadGroup);
  EXPECT_EQ(session.pose(pin).p.z(), 3.0) << "ada has undone what bob did";
  EXPECT_EQ(session.world.find(pin)->holder, bob);
  EXPECT_EQ(session.world.find(peg)->holder, ada);
}

TEST_F(PeopleTest, WhatIsSaidOfAClashStaysInOrderWhileItIsOpen) {
  const ClashEvent event = clash();
  Details first = review_of(event, ReviewStatus::kActive, "who takes it?");
  ask(ada, CommandKind::kReview, {}, first);
  Details second = review_of(event, ReviewStatus::kReviewed, "I do");
  second.other_user = bob;
  ask(bob, CommandKind::kReview, {}, second);
  tick();
  const std::vector<Remark> told = snapshot_of(session.world).remarks;
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].user, ada);
  EXPECT_EQ(told[0].text, "who takes it?");
  EXPECT_FALSE(told[0].assignee);
  EXPECT_EQ(told[1].user, bob);
  EXPECT_EQ(told[1].assignee, bob);
  EXPECT_EQ(told[1].status, ReviewStatus::kReviewed);
  EXPECT_EQ(told[1].tick, session.world.tick);
  EXPECT_EQ(twin.world.remarks, session.world.remarks);
  second.other_user = UserId{99};
  EXPECT_EQ(refusal(bob, CommandKind::kReview, {}, second), Refusal::kUnknownUser);
  // The oldest of a clash go; those of others stay.
  second.other_user = {};
  for (int i = 0; i < 80; ++i) ask(bob, CommandKind::kReview, {}, second);
  EXPECT_EQ(session.world.remarks.size(), 64U);
  // What is said next of another clash takes those of an ended one away.
  move(ada, peg, Vec3(-5, 0, 0));
  move(ada, peg, Vec3(5, 0, 0));
  const ClashEvent anew = snapshot_of(session.world).open_clashes.at(0);
  ASSERT_NE(anew.clash, event.clash);
  ask(ada, CommandKind::kReview, {}, review_of(anew, ReviewStatus::kActive, "again"));
  ASSERT_EQ(session.world.remarks.size(), 1U);
  EXPECT_EQ(session.world.remarks[0].text, "again");
}

}  // namespace
}  // namespace mortise
