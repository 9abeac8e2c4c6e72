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
  EXPECT_EQ(client.policy(), "stop");
  EXPECT_TRUE(client.standing().empty());  // what holds is what the session says that holds
  decide({Kind::kLeave, UserId{1}, PartId{}, ""});
  EXPECT_FALSE(client.users()[0].present);
}

Decision rule(std::uint32_t part) {
  return {Decision::Kind::kSetExclusion, UserId{1}, PartId{part}, {}};
}

TEST(Client, ShowsWhatTheSessionSaysThatHolds) {
  MemoryHub hub;
  const auto server = hub.open_server();
  const auto channel = hub.open_client();
  Client client(*channel);
  Snapshot snapshot;
  snapshot.session = "bench";
  snapshot.tick = 5;
  snapshot.standing = {rule(1)};
  server->publish_snapshot(snapshot);
  EXPECT_TRUE(client.poll().standing);
  EXPECT_EQ(client.standing(), std::vector<Decision>{rule(1)});
  const StandingChange changes[] = {{6, false, rule(1)}, {6, true, rule(2)}};
  server->publish_standing(changes);
  EXPECT_TRUE(client.poll().standing);
  EXPECT_EQ(client.standing(), std::vector<Decision>{rule(2)});
  EXPECT_FALSE(client.poll().standing);
}

TEST(KnownStanding, IsTheSameWhicheverComesFirst) {
  Snapshot five, six;
  five.tick = 5;
  five.standing = {rule(1)};
  six.tick = 6;
  six.standing = {rule(2)};
  const StandingChange off{6, false, rule(1)}, on{6, true, rule(2)}, later{7, true, rule(3)};
  const std::vector<Decision> expected = {rule(2), rule(3)};
  {
    KnownStanding known;  // changes before the snapshot that they change
    for (const StandingChange& change : {off, on, later}) known.take(change);
    known.take(five);
    EXPECT_EQ(known.decisions(), expected);
  }
  {
    KnownStanding known;  // changes that the snapshot has
    known.take(six);
    EXPECT_FALSE(known.take(off));
    EXPECT_FALSE(known.take(on));
    known.take(later);
    EXPECT_EQ(known.decisions(), expected);
    EXPECT_FALSE(known.take(six)) << "again";
    EXPECT_FALSE(known.take(five)) << "an older one";
    EXPECT_EQ(known.decisions(), expected);
  }
  KnownStanding known;
  known.take(six);
  known.take(later);
  known.expect_another_server();
  EXPECT_EQ(known.decisions(), expected) << "until that one says something else";
  Snapshot anew;
  anew.tick = 1;
  known.take(anew);
  EXPECT_TRUE(known.decisions().empty());
}

}  // namespace
}  // namespace mortise
