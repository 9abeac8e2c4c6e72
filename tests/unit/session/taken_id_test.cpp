// The id of a user who left long ago goes to somebody else: nothing of that user goes with it.
#include "common/session/memory/session_state.h"
#include "common/session/tick/statistics.h"
#include "tests/unit/session/three_people.h"

namespace mortise {
namespace {

struct TakenIdTest : PeopleTest {
  void decide(const Decision& decision) {
    for (SessionBuilder* one : {&session, &twin}) apply_decision(one->world, decision);
  }
  /// Ada leaves, and Dora gets her id.
  Decision dora_for_ada() {
    decide({Decision::Kind::kLeave, ada, {}, {}});
    Decision join{Decision::Kind::kJoin, ada, {}, "dora", Role::kDesigner};
    join.details.text = "ada";
    decide(join);
    session.next_seq[ada.value - 1] = 1;
    return join;
  }
};

TEST_F(TakenIdTest, TheNewOneIsSomebodyElse) {
  EXPECT_TRUE(takes_over_id(dora_for_ada()));
  EXPECT_EQ(session.world.users.size(), 3u);
  EXPECT_EQ(session.world.find(ada)->name, "dora");
  EXPECT_TRUE(session.world.find(ada)->present);
  EXPECT_FALSE(takes_over_id({Decision::Kind::kJoin, ada, {}, "ada", Role::kDesigner}))
      << "who comes back is the same";
}

TEST_F(TakenIdTest, MovesOfBeforeAreNobodysToTakeBack) {
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(1, 0, 0));
  ask(ada, CommandKind::kRelease, peg);
  dora_for_ada();
  ask(ada, CommandKind::kGrab, peg);
  const Reply undo = ask(ada, CommandKind::kUndo, peg);
  EXPECT_EQ(undo.refusal, Refusal::kMovedBySomeoneElse);
  EXPECT_NE(undo.text.find("a user who left"), std::string::npos) << undo.text;
  move(ada, peg, Vec3(1, 0, 0));  // her own she can
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg), Refusal::kNone);
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, peg), Refusal::kMovedBySomeoneElse);
  tick();
}

TEST_F(TakenIdTest, NorToRepeat) {
  ask(ada, CommandKind::kGrab, peg);
  move(ada, peg, Vec3(1, 0, 0));
  ask(ada, CommandKind::kUndo, peg);
  ask(ada, CommandKind::kRelease, peg);
  dora_for_ada();
  ask(ada, CommandKind::kGrab, peg);
  EXPECT_EQ(refusal(ada, CommandKind::kRedo, peg), Refusal::kNothingToRedo);
}

TEST_F(TakenIdTest, AReviewKeepsWhatWasSaidAndNotWhoNowHasTheId) {
  const ClashEvent event = clash();
  ask(ada, CommandKind::kReview, {}, review_of(event, ReviewStatus::kReviewed, "as drawn"));
  tick();
  dora_for_ada();
  tick();
  const Snapshot now = snapshot_of(session.world);
  ASSERT_EQ(now.open_clashes.size(), 1u);
  EXPECT_EQ(now.open_clashes[0].review.comment, "as drawn");
  EXPECT_EQ(now.open_clashes[0].review.status, ReviewStatus::kReviewed);
  EXPECT_FALSE(now.open_clashes[0].review.user);
  EXPECT_FALSE(now.open_clashes[0].user) << "who caused it";
}

TEST_F(TakenIdTest, ARuleStandsAndIsNobodys) {
  ask(ada, CommandKind::kSetPolicy, {}, with_text("stop"));
  dora_for_ada();
  ASSERT_EQ(session.world.standing.size(), 1u);
  EXPECT_EQ(session.world.policy, Policy::kStop);
  EXPECT_FALSE(session.world.standing[0].user);
}

TEST_F(TakenIdTest, SumsOfBeforeAreNotTheNewOnes) {
  ask(ada, CommandKind::kGrab, peg);
  SessionStatistics statistics;
  statistics.add(move(ada, peg, Vec3(15, 0, 0)));
  ASSERT_EQ(statistics.by_user().count(ada), 1u);
  const Decision join = dora_for_ada();
  statistics.forget_users({&join, 1});
  statistics.add(tick());
  EXPECT_EQ(statistics.by_user().count(ada), 0u);
  EXPECT_EQ(statistics.by_part().count(peg), 1u);
  EXPECT_TRUE(statistics.is_whole());
}

}  // namespace
}  // namespace mortise
