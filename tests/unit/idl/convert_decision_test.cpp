// The door for what people say and what is decided.
#include <gtest/gtest.h>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "tests/support/numbers.h"
#include "tests/unit/idl/samples.h"

namespace mortise {
namespace {

TEST(Convert, DetailsOfACommandGoRound) {
  Request command;
  command.kind = Request::Kind::kCommand;
  command.command = {UserId{3}, PartId{4}, 5, CommandKind::kSetTolerance, test::some_details(), 77};
  const Result<Request> back = from_wire(to_wire(command));
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ(back->command.after, 77u);
  EXPECT_EQ(back->command.details, command.command.details);
}

TEST(Convert, DetailsAreRefused) {
  const auto passes = [](auto change) {
    Request command;
    command.kind = Request::Kind::kCommand;
    command.command = {UserId{3}, PartId{4}, 5, CommandKind::kReview, test::some_details()};
    wire::Request request = to_wire(command);
    change(request.command()[0].details());
    return static_cast<bool>(from_wire(request));
  };
  using D = wire::Details;
  EXPECT_TRUE(passes([](D&) {}));
  EXPECT_FALSE(passes([](D& d) { d.parts().resize(kMostGroupParts + 1, 1); }));
  EXPECT_FALSE(passes([](D& d) { d.parts() = {1, 0}; }));
  EXPECT_FALSE(passes([](D& d) { d.pair()[0].feature(std::string(129, 'x')); }));
  EXPECT_FALSE(passes([](D& d) { d.pair()[0].other().feature("a\nb"); }));
  EXPECT_FALSE(passes([](D& d) { d.pair().resize(2); }));
  EXPECT_FALSE(passes([](D& d) { d.review()[0].status(kReviewStatusCount); }));
  EXPECT_FALSE(passes([](D& d) { d.review().resize(2); }));
  EXPECT_FALSE(passes([](D& d) { d.text(std::string(1025, 'x')); }));
  EXPECT_FALSE(passes([](D& d) { d.text("bell \a"); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint()[0].kind(kConstraintKindCount); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint()[0].distance_mm(kNan); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint()[0].distance_mm(-kInf); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint()[0].held().feature(std::string(129, 'x')); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint()[0].other().feature(std::string(129, 'x')); }));
  EXPECT_FALSE(passes([](D& d) { d.constraint().resize(2); }));
}

TEST(Convert, DecisionsGoRoundAndAreRefused) {
  Decision sent{Decision::Kind::kJoin, UserId{2}, PartId{3}, "anna", Role::kBot};
  sent.details = test::some_details();
  const Decision decisions[] = {sent};
  const Result<Answers> got = from_wire(to_wire({}, {}, {}, decisions));
  ASSERT_TRUE(got) << got.error().text;
  ASSERT_EQ(got->decisions.size(), 1u);
  EXPECT_EQ(got->decisions[0], sent);
  const auto passes = [&](auto change) {
    wire::Decision decision = to_wire(sent);
    change(decision);
    return static_cast<bool>(from_wire(decision));
  };
  EXPECT_FALSE(passes([](wire::Decision& d) { d.kind(0); }));
  EXPECT_FALSE(passes([](wire::Decision& d) { d.kind(kDecisionKindCount); }));
  EXPECT_FALSE(passes([](wire::Decision& d) { d.role(kRoleCount); }));
  EXPECT_FALSE(passes([](wire::Decision& d) { d.user_name("a\tb"); }));
  EXPECT_FALSE(passes([](wire::Decision& d) { d.details().text("a\tb"); }));
}

TEST(Convert, WhatHoldsGoesRoundAndIsRefused) {
  const StandingChange sent[] = {
      {9, true, {Decision::Kind::kAddConstraint, UserId{2}, PartId{3}, {}}},
      {9, false, {Decision::Kind::kSetPolicy, UserId{2}, {}, {}}}};
  wire::Answers answers = to_wire({}, {}, {}, {}, sent);
  const Result<Answers> got = from_wire(answers);
  ASSERT_TRUE(got) << got.error().text;
  ASSERT_EQ(got->standing.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(got->standing[i].tick, sent[i].tick);
    EXPECT_EQ(got->standing[i].holds, sent[i].holds);
    EXPECT_EQ(got->standing[i].decision, sent[i].decision);
  }
  answers.standing()[1].decision().kind(0);
  EXPECT_FALSE(from_wire(answers));
}

TEST(Convert, ReviewsGoRoundInEventsAndSnapshots) {
  ClashEvent sent = test::some_clash();
  sent.kind = ClashEvent::Kind::kReview;
  sent.cause = Decision::Kind::kReview;
  sent.review = {ReviewStatus::kApproved, "press fit", UserId{7}, 12};
  sent.approval_lost = true;
  const ClashEvent events[] = {sent, test::some_clash(9)};
  std::uint64_t malformed = 0;
  wire::EventBatch batch = cut(events)[0];
  std::vector<ClashEvent> got = events_from_wire(batch, malformed);
  ASSERT_EQ(got.size(), 2u);
  test::expect_same(got[0], sent);
  EXPECT_EQ(got[1].review.status, ReviewStatus::kNew);
  batch.events()[0].review().status(kReviewStatusCount);
  EXPECT_EQ(events_from_wire(batch, malformed).size(), 1u);
  EXPECT_EQ(malformed, 1u);

  Snapshot snapshot;
  snapshot.session = "test";
  snapshot.policy = "stop";
  snapshot.users = {{UserId{1}, "anna", true, Role::kObserver}};
  snapshot.open_clashes = {sent};
  snapshot.standing = {{Decision::Kind::kSetPolicy, UserId{1}, PartId{}, ""}};
  snapshot.notes = {{PartId{2}, "all triangles faced inwards and were turned"}};
  snapshot.remarks = {{ClashId{3}, UserId{1}, UserId{2}, ReviewStatus::kActive, 77, "see there"}};
  wire::Snapshot chunk = cut(snapshot, 1)[0];
  const Result<Snapshot> back = from_wire(chunk);
  ASSERT_TRUE(back) << back.error().text;
  ASSERT_EQ(back->notes.size(), 1u);
  EXPECT_EQ(back->notes[0].part, PartId{2});
  EXPECT_EQ(back->notes[0].text, snapshot.notes[0].text);
  EXPECT_EQ(back->remarks, snapshot.remarks);
  wire::Snapshot of_no_clash = chunk;
  of_no_clash.remarks()[0].clash(0);
  EXPECT_FALSE(from_wire(of_no_clash));
  wire::Snapshot of_no_part = chunk;
  of_no_part.notes()[0].part(0);
  EXPECT_FALSE(from_wire(of_no_part));
  EXPECT_EQ(back->users[0].role, Role::kObserver);
  test::expect_same(back->open_clashes[0], sent);
  ASSERT_EQ(back->standing.size(), 1u);
  chunk.users()[0].role(kRoleCount);
  EXPECT_FALSE(from_wire(chunk));
}

}  // namespace
}  // namespace mortise
