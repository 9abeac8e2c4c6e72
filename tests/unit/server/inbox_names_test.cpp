// How many names a session remembers, and who gets whose id.
#include "client/client.h"
#include "common/messages/memory_channel.h"
#include "tests/unit/server/inbox_bench.h"

namespace mortise {
namespace {

using namespace mortise::testing;

class InboxNamesTest : public ::testing::Test {
 protected:
  UserId join(const std::string& name) {
    ServerInput input;
    input.joins.push_back({name, ++nonce_, name, "designer"});
    inbox_.admit(std::move(input), world_, now_ns_, intake_);
    return intake_.join_replies.at(0).user;
  }
  void leave(UserId user, const std::string& name) {
    ServerInput input;
    input.lost.push_back({user, name, true});
    inbox_.admit(std::move(input), world_, now_ns_, intake_);
  }
  Refusal command(const std::string& name, UserId user, PartId part, CommandKind kind,
                  std::uint64_t after = 0) {
    ServerInput input;
    Command command{user, part, ++seq_, kind};
    command.after = after;
    input.commands.push_back({name, command});
    inbox_.admit(std::move(input), world_, now_ns_, intake_);
    return intake_.replies.empty() ? Refusal::kNone : intake_.replies.back().refusal;
  }

  World world_ = small_world();
  Inbox inbox_{{.max_users = 3, .names_kept = 3}};
  Intake intake_;
  std::int64_t now_ns_ = kSecond_ns;
  std::uint64_t nonce_ = 0, seq_ = 0;
};

TEST_F(InboxNamesTest, TenThousandNamesLeaveNothingBehind) {
  const UserId anna = join("anna");
  for (int i = 0; i < 10'000; ++i) {
    const std::string name = "guest" + std::to_string(i);
    const UserId guest = join(name);
    ASSERT_TRUE(guest);
    ASSERT_NE(guest, anna);
    command(name, guest, kRed, CommandKind::kGrab);
    leave(guest, name);
  }
  EXPECT_EQ(world_.users.size(), 3u);
  EXPECT_EQ(inbox_.user_counters().size(), 3u);
  EXPECT_EQ(snapshot_of(world_).users.size(), 3u);
  EXPECT_EQ(inbox_.users_present(), 1u);
  EXPECT_EQ(world_.find(anna)->name, "anna");
}

TEST_F(InboxNamesTest, WhoHasBeenGoneLongestGivesTheId) {
  const UserId anna = join("anna"), ben = join("ben"), cid = join("cid");
  leave(ben, "ben");
  leave(anna, "anna");
  EXPECT_EQ(join("dora"), ben);
  ASSERT_EQ(intake_.decisions.size(), 1u);
  EXPECT_TRUE(takes_over_id(intake_.decisions[0]));
  EXPECT_EQ(intake_.decisions[0].details.text, "ben");
  EXPECT_EQ(join("anna"), anna) << "who is remembered is the same";
  EXPECT_FALSE(takes_over_id(intake_.decisions[0]));
  leave(cid, "cid");
  EXPECT_EQ(join("ben"), cid) << "who was forgotten is new";
}

TEST_F(InboxNamesTest, AfterARestoreItIsTheLowestId) {
  for (const char* name : {"anna", "ben", "cid"}) {
    world_.users.push_back(
        {UserId{static_cast<std::uint32_t>(world_.users.size()) + 1}, name, false, 0, {}});
  }
  EXPECT_EQ(join("ben"), UserId{2});
  EXPECT_EQ(join("dora"), UserId{1});
  EXPECT_EQ(join("eve"), UserId{3});
}

TEST_F(InboxNamesTest, CountersBeginAnew) {
  const UserId anna = join("anna");
  join("ben");
  join("cid");
  command("anna", anna, kRed, CommandKind::kGrab);
  EXPECT_EQ(inbox_.user_counters().at(0).commands, 1u);
  leave(anna, "anna");
  EXPECT_EQ(join("dora"), anna);
  EXPECT_EQ(inbox_.user_counters().at(0).commands, 0u);
  EXPECT_EQ(inbox_.counters().commands, 1u) << "of all";
}

// A release that waited for increments, of somebody who was lost meanwhile.
TEST_F(InboxNamesTest, WhatStillWaitsIsNotCarriedOutForTheNewOne) {
  const UserId anna = join("anna");
  join("ben");
  join("cid");
  command("anna", anna, kRed, CommandKind::kGrab);
  command("anna", anna, kRed, CommandKind::kRelease, 5);
  ASSERT_EQ(inbox_.waiting_commands(), 1u);
  ServerInput input;
  input.lost.push_back({UserId{}, "anna", false});
  input.joins.push_back({"dora", ++nonce_, "dora", "designer"});
  inbox_.admit(std::move(input), world_, now_ns_, intake_);
  ASSERT_EQ(intake_.join_replies.at(0).user, anna);
  EXPECT_EQ(inbox_.waiting_commands(), 0u);
  EXPECT_EQ(command("dora", anna, kRed, CommandKind::kGrab), Refusal::kNone);
  now_ns_ += kSecond_ns;
  inbox_.admit({}, world_, now_ns_, intake_);
  EXPECT_EQ(world_.find(kRed)->holder, anna);
}

// A client hears of it: in what it knows of clashes and rules, and of itself.
TEST_F(InboxNamesTest, AClientWhoseIdIsTakenJoinsAgain) {
  MemoryHub hub;
  const auto server = hub.open_server();
  const auto channel = hub.open_client();
  std::int64_t client_ns = 100 * kSecond_ns;
  Client client(*channel, ClientOptions{}, [&] { return client_ns; });
  client.add_user("anna", "designer");
  const auto turn = [&] {
    client.poll();
    client_ns += kSecond_ns / 10;
    inbox_.admit(server->take(), world_, now_ns_ += kSecond_ns / 10, intake_);
    for (const JoinReply& reply : intake_.join_replies) server->publish_join_reply(reply);
    if (!intake_.decisions.empty()) server->publish_decisions(intake_.decisions);
    if (intake_.joined) server->publish_snapshot(snapshot_of(world_));
    client.poll();
  };
  for (int i = 0; i < 5; ++i) turn();
  const UserId anna = client.user_id(0);
  ASSERT_TRUE(anna);
  ClashEvent clash;
  clash.clash = ClashId{7};
  clash.user = anna;
  clash.review = {ReviewStatus::kReviewed, "mine", anna, 1};
  clash.seq = 1;
  clash.kind = ClashEvent::Kind::kBegin;
  const std::vector<ClashEvent> events{clash};
  server->publish_events(events);
  turn();
  ASSERT_EQ(client.open_clashes().size(), 1u);

  // The server takes her for gone while the process is frozen, and the id goes to dora.
  Decision gone{Decision::Kind::kLivelinessLost, anna, {}, {}};
  Decision join{Decision::Kind::kJoin, anna, {}, "dora", Role::kDesigner};
  join.details.text = "anna";
  const std::vector<Decision> decisions{gone, join};
  server->publish_decisions(decisions);
  client.poll();
  const ClashEvent& known = client.open_clashes().begin()->second;
  EXPECT_FALSE(known.user);
  EXPECT_FALSE(known.review.user);
  EXPECT_EQ(known.review.comment, "mine");
  client_ns += 10 * kSecond_ns;
  client.poll();
  client.poll();
  EXPECT_FALSE(server->take().joins.empty()) << "she asks to join again";
}

}  // namespace
}  // namespace mortise
