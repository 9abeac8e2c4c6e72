#pragma once
#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/session/session_builder.h"

namespace mortise {

inline Details with_text(const std::string& text) {
  Details details;
  details.text = text;
  return details;
}
inline Details with_parts(std::vector<PartId> parts) {
  Details details;
  details.parts = std::move(parts);
  return details;
}
inline Details with_other(PartId other, const std::string& text) {
  Details details = with_text(text);
  details.other_part = other;
  return details;
}

/// A wall of 10 mm about x = 20 and two cubes of 2 mm, at the origin and at y = 50; a twin of it
/// gets the decisions only, as a replay does.
struct PeopleTest : ::testing::Test {
  SessionBuilder session, twin;
  PartId wall, peg, pin;
  UserId ada, bob, eve;
  Scratch scratch, twin_scratch;

  PeopleTest() {
    for (SessionBuilder* one : {&session, &twin}) {
      wall = one->add("wall", cube_mesh(10), at(20, 0, 0), false);
      peg = one->add("peg", cube_mesh(2), at(0, 0, 0), true);
      pin = one->add("pin", cube_mesh(2), at(0, 50, 0), true);
      ada = one->join("ada");
      bob = one->join("bob");
      eve = one->join("eve", Role::kObserver);
    }
  }

  Reply ask(UserId user, CommandKind kind, PartId part, Details details = {}) {
    Decision decision;
    Reply reply = apply_command(session.world, {user, part, 1, kind, std::move(details)}, decision);
    EXPECT_EQ(reply.refusal == Refusal::kNone, decision.kind != Decision::Kind::kUnknown);
    EXPECT_TRUE(reply.refusal == Refusal::kNone || !reply.text.empty());
    if (reply.refusal == Refusal::kNone) apply_decision(twin.world, decision);
    return reply;
  }
  Refusal refusal(UserId user, CommandKind kind, PartId part, Details details = {}) {
    return ask(user, kind, part, std::move(details)).refusal;
  }
  StepReport tick(const std::vector<Increment>& increments = {}) {
    const StepReport report = play_tick(session.world, increments, scratch);
    const StepReport replayed = play_tick(twin.world, increments, twin_scratch);
    EXPECT_EQ(report.state_hash, replayed.state_hash);
    EXPECT_EQ(report.events.size(), replayed.events.size());
    return report;
  }
  StepReport move(UserId user, PartId part, const Vec3& by) {
    StepReport report = tick({session.push(user, part, by)});
    EXPECT_TRUE(report.refused.empty());
    return report;
  }
  /// Peg reaches 1 mm into the wall, held by ada.
  ClashEvent clash() {
    ask(ada, CommandKind::kGrab, peg);
    const StepReport report = move(ada, peg, Vec3(15, 0, 0));
    EXPECT_EQ(report.events.size(), 1U);
    return report.events.at(0);
  }
  Details review_of(const ClashEvent& event, ReviewStatus status, const std::string& comment = "") {
    Details details = with_text(comment);
    details.clash = event.clash;
    details.status = status;
    return details;
  }
};

}  // namespace mortise
