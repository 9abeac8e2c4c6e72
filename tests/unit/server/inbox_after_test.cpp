// A command waits for the increments that were sent before it and have not come yet.
#include <gtest/gtest.h>

#include <memory>

#include "client/client.h"
#include "common/messages/memory_channel.h"
#include "tests/unit/server/inbox_bench.h"

namespace mortise {
namespace {

using namespace mortise::testing;

class InboxAfterTest : public InboxTest {
 protected:
  /// A command of Anna about the red part, sent behind her increment `after`.
  void say(CommandKind kind, std::uint64_t after) {
    ServerInput input;
    input.commands.push_back({"a", {anna_, kRed, ++command_seq_, kind, {}, after}});
    admit(std::move(input));
  }
  void arrive(std::uint64_t seq) {
    ServerInput input;
    input.increments.push_back(increment("a", anna_, kRed, seq));
    input.increments.back().kept_from = 1;
    admit(std::move(input));
  }
  void pass(double seconds) {
    now_ns_ += static_cast<std::int64_t>(seconds * 1e9);
    admit({});
  }
  UserId holder() const { return world_.find(kRed)->holder; }
};

TEST_F(InboxAfterTest, AReleaseWaitsForWhatIsOnItsWay) {
  arrive(1);
  say(CommandKind::kRelease, 3);
  EXPECT_EQ(holder(), anna_);
  pass(0.1);
  EXPECT_EQ(holder(), anna_);
  arrive(3);  // beyond a hole
  pass(0.1);
  EXPECT_EQ(holder(), anna_);
  arrive(2);
  EXPECT_EQ(intake_.increments.size(), 2U);
  EXPECT_EQ(holder(), anna_) << "decisions come before the increments of a tick";
  admit({});
  EXPECT_FALSE(holder());
  EXPECT_EQ(inbox_.counters().commands_deferred, 1U);
  EXPECT_EQ(inbox_.counters().commands_overdue, 0U);
}

TEST_F(InboxAfterTest, NotForEver) {
  arrive(1);
  say(CommandKind::kUndo, ~0ULL);
  pass(0.49);
  EXPECT_EQ(inbox_.waiting_commands(), 1U);
  EXPECT_EQ(inbox_.counters().commands_overdue, 0U);
  pass(0.02);
  EXPECT_EQ(inbox_.waiting_commands(), 0U);
  EXPECT_EQ(inbox_.counters().commands_overdue, 1U);
  ASSERT_EQ(intake_.replies.size(), 1U);
}

TEST_F(InboxAfterTest, OthersAndOtherCommandsDoNotWait) {
  say(CommandKind::kRelease, 5);
  EXPECT_EQ(holder(), anna_);
  EXPECT_EQ(command("b", ben_, kBlue, CommandKind::kGrab).refusal, Refusal::kNone);
  EXPECT_EQ(world_.find(kBlue)->holder, ben_);
  ServerInput input;
  input.commands.push_back({"b", {ben_, kBlue, ++command_seq_, CommandKind::kGrab, {}, 100}});
  admit(std::move(input));
  EXPECT_EQ(inbox_.waiting_commands(), 1U) << "a grab ends no drag";
  // What Anna says of the same part stays behind her release.
  say(CommandKind::kGrab, 5);
  EXPECT_EQ(inbox_.waiting_commands(), 2U);
  pass(0.6);
  EXPECT_EQ(inbox_.waiting_commands(), 0U);
  EXPECT_EQ(holder(), anna_);
  EXPECT_EQ(inbox_.counters().commands_overdue, 1U);
}

TEST_F(InboxAfterTest, WhatCameOrIsLostIsNotWaitedFor) {
  arrive(1);
  ServerInput input;  // the sender keeps nothing before 4 any more
  input.increments.push_back(increment("a", anna_, kRed, 4));
  input.increments.back().kept_from = 4;
  admit(std::move(input));
  admit({});
  say(CommandKind::kRelease, 4);
  EXPECT_FALSE(holder());
  EXPECT_EQ(inbox_.counters().lost, 2U);
  EXPECT_EQ(inbox_.counters().commands_overdue, 0U);
}

/// A drag of 10 mm, then a release, over a channel that loses, delays, doubles and reorders. Where
/// the part lies in the end, and how many commands did not wait long enough.
struct Drag {
  double x_mm = 0.0;
  std::uint64_t overdue = 0, deferred = 0;
};
Drag drag_over(const MemoryFaults& faults) {
  World world = small_world();
  MemoryHub hub(faults, {});
  const auto server = hub.open_server();
  const auto channel = hub.open_client();
  std::int64_t now_ns = kSecond_ns;
  Client client(*channel, {}, [&] { return now_ns; });
  const LocalUser anna = client.add_user("anna", "designer");
  Inbox inbox(InboxLimits{});
  Intake intake;
  const auto turn = [&] {
    now_ns += kSecond_ns / 60;
    inbox.admit(server->take(), world, now_ns, intake);
    for (const JoinReply& reply : intake.join_replies) server->publish_join_reply(reply);
    server->publish_replies(intake.replies);
    for (const Increment& increment : intake.increments)
      world.find(increment.part)->X_WP.p += increment.translation_mm;
    PoseBatch batch;
    batch.acks = intake.acks;
    server->publish_poses(batch);
    server->publish_snapshot(snapshot_of(world));
    client.poll();
  };
  for (int i = 0; i < 5; ++i) turn();
  client.grab(anna, kRed);
  for (int i = 0; i < 3; ++i) turn();
  for (int i = 0; i < 100; ++i) {
    client.send(anna, kRed, Vec3(0.1, 0, 0));
    turn();
  }
  client.release(anna, kRed);
  for (int i = 0; i < 60; ++i) turn();
  EXPECT_FALSE(world.find(kRed)->holder);
  return {world.find(kRed)->X_WP.p.x() - 20.0, inbox.counters().commands_overdue,
          inbox.counters().commands_deferred};
}

TEST(ReleaseOnABadLink, LosesNoIncrement) {
  std::uint64_t deferred = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    MemoryFaults faults;
    faults.loss = 0.3;
    faults.duplicate = faults.reorder = 0.1;
    faults.delay_takes = 4;
    faults.seed = seed;
    const Drag drag = drag_over(faults);
    EXPECT_NEAR(drag.x_mm, 10.0, 1e-9) << "seed " << seed;
    EXPECT_EQ(drag.overdue, 0U);
    deferred += drag.deferred;
  }
  EXPECT_GT(deferred, 30U) << "the link was bad enough to need it";
  EXPECT_EQ(drag_over({}).overdue, 0U);
}

TEST(ReleaseOnABadLink, IsCarriedOutWhereNothingComesAnyMore) {
  MemoryFaults dead;
  dead.loss = 1.0;
  const Drag drag = drag_over(dead);
  EXPECT_EQ(drag.x_mm, 0.0);
  EXPECT_EQ(drag.overdue, 1U);
}

}  // namespace
}  // namespace mortise
