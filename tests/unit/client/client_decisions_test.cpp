// What a client knows of people and rules follows the server's decisions.
#include <gtest/gtest.h>

#include <span>

#include "client/client.h"
#include "common/messages/memory_channel.h"

namespace mortise {
namespace {

TEST(Client, FollowsWhatTheServerDecides) {
  MemoryHub hub;
  const auto server = hub.open_server();
  const auto channel = hub.open_client();
  Client client(*channel);
  Snapshot snapshot;
  snapshot.session = "bench";
  snapshot.policy = "report";
  server->publish_snapshot(snapshot);
  client.poll();
  const auto decide = [&](Decision decision) {
    server->publish_decisions(std::span<const Decision>(&decision, 1));
    const ClientUpdate update = client.poll();
    ASSERT_EQ(update.decisions.size(), 1U);
    EXPECT_EQ(update.decisions[0].kind, decision.kind);
  };
  using Kind = Decision::Kind;
  decide({Kind::kJoin, UserId{1}, PartId{}, "anna", Role::kDesigner});
  decide({Kind::kJoin, UserId{2}, PartId{}, "eve", Role::kObserver});
  ASSERT_EQ(client.users().size(), 2U);
  EXPECT_EQ(client.users()[1].name, "eve");
  EXPECT_EQ(client.users()[1].role, Role::kObserver);
  EXPECT_TRUE(client.users()[1].present);

  Decision policy{Kind::kSetPolicy, UserId{1}, PartId{}, ""};
  policy.details.text = "stop";
  decide(policy);
  decide(policy);
  EXPECT_EQ(client.policy(), "stop");
  EXPECT_EQ(client.standing().size(), 1U);  // the last word counts
  Decision exclude{Kind::kSetExclusion, UserId{1}, PartId{1}, ""};
  exclude.details.other_part = PartId{2};
  decide(exclude);
  Decision include{Kind::kDropExclusion, UserId{1}, PartId{2}, ""};
  include.details.other_part = PartId{1};
  decide(include);
  ASSERT_EQ(client.standing().size(), 2U);
  EXPECT_EQ(client.standing()[1].kind, Kind::kDropExclusion);
  decide({Kind::kAskHandOver, UserId{2}, PartId{3}, ""});
  EXPECT_EQ(client.standing().size(), 3U);
  decide({Kind::kDecline, UserId{1}, PartId{3}, ""});
  EXPECT_EQ(client.standing().size(), 2U);
  decide({Kind::kAddConstraint, UserId{1}, PartId{3}, ""});
  decide({Kind::kLeave, UserId{1}, PartId{}, ""});
  EXPECT_EQ(client.standing().size(), 2U);  // what guided the user's parts is over
  EXPECT_FALSE(client.users()[0].present);
}

}  // namespace
}  // namespace mortise
