// The thin client over a memory channel: what it knows stays right whatever the network does.
#include "client/client.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/messages/memory_channel.h"

namespace mortise {
namespace {

/// A server's bare bones and one clock for all, 10 ms a turn.
class Bench {
 public:
  explicit Bench(const MemoryFaults& up = {}, const MemoryFaults& down = {}) : hub(up, down) {
    restart();
    for (std::uint32_t i = 1; i <= 5; ++i) parts[PartId{i}] = {};
  }
  void restart() {
    server = hub.open_server();
    users.clear();
    tick = event_seq = 0;
    open.clear();
  }
  std::unique_ptr<Client> client(ClientChannel& channel) {
    return std::make_unique<Client>(channel, ClientOptions{}, [this] { return now_ns; });
  }
  Snapshot snapshot() const {
    Snapshot result;
    result.session = "bench";
    result.tick = tick;
    result.event_seq = event_seq;
    for (const auto& [id, pose] : parts) {
      PartInfo part;
      part.part = id;
      part.name = "part" + std::to_string(id.value);
      part.X_WP = pose;
      result.parts.push_back(part);
    }
    for (const auto& [id, key] : users)
      result.users.push_back({id, names.at(id), !gone.contains(id)});
    for (const auto& [id, clash] : open) result.open_clashes.push_back(clash);
    return result;
  }
  ClashEvent next_event(ClashEvent::Kind kind, std::uint32_t clash) {
    ClashEvent event;
    event.kind = kind;
    event.seq = ++event_seq;
    event.tick = tick;
    event.clash = ClashId{clash};
    event.part_a = PartId{1};
    event.part_b = PartId{2};
    if (kind == ClashEvent::Kind::kEnd) {
      open.erase(event.clash);
    } else {
      open[event.clash] = event;
    }
    return event;
  }
  void say(const ClashEvent& event) { server->publish_events(std::span(&event, 1)); }

  void turn() {
    now_ns += 10'000'000;
    ++tick;
    input = server->take();
    joins += input.joins.size();
    for (const JoinRequest& join : input.joins) {
      UserId id;
      for (const auto& [known, who] : users) {
        if (who == std::pair(join.client, join.nonce)) id = known;
      }
      if (!id) id = UserId{static_cast<std::uint32_t>(users.size()) + 1};
      users[id] = {join.client, join.nonce};
      names[id] = join.name;
      gone.erase(id);
      if (answer_joins) {
        server->publish_join_reply({join.client, join.nonce, id, Refusal::kNone, ""});
      }
    }
    PoseBatch batch;
    batch.tick = tick;
    batch.event_seq = event_seq;
    for (const ReceivedIncrement& received : input.increments) {
      const Increment& increment = received.increment;
      if (gone.contains(increment.user) || increment.seq <= seen[increment.user]) continue;
      seen[increment.user] = increment.seq;
      Pose& pose = parts[increment.part];
      pose.p += increment.translation_mm;
      batch.parts.push_back({increment.part, increment.user, pose});
      batch.acks.push_back({increment.user, increment.seq, received.sent_ns});
    }
    if (!batch.parts.empty()) server->publish_poses(batch);
    const bool asked = !input.snapshot_requests.empty();
    requests += asked;
    if (asked || !input.joins.empty()) server->publish_snapshot(snapshot());
  }

  MemoryHub hub;
  std::unique_ptr<ServerChannel> server;
  ServerInput input;
  std::map<UserId, std::pair<ClientKey, std::uint64_t>> users;
  std::map<UserId, std::string> names;
  std::set<UserId> gone;
  std::map<UserId, std::uint64_t> seen;
  std::map<PartId, Pose> parts;
  std::map<ClashId, ClashEvent> open;
  std::uint64_t tick = 0, event_seq = 0, requests = 0, joins = 0;
  std::int64_t now_ns = 1'000'000'000;
  bool answer_joins = true;
};

/// A client over one channel, with a user who has asked to join.
struct OneClient : testing::Test {
  Bench bench;
  std::unique_ptr<ClientChannel> channel = bench.hub.open_client();
  std::unique_ptr<Client> client = bench.client(*channel);
  const LocalUser a = client->add_user("a", "bot");

  ClientUpdate run(int turns) {
    ClientUpdate all;
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    for (int i = 0; i < turns; ++i) {
      bench.turn();
      const ClientUpdate update = client->poll();
      append(all.events, update.events);
      append(all.joined, update.joined);
      append(all.acks, update.acks);
      append(all.given_up, update.given_up);
      append(all.latency_ms, update.latency_ms);
      append(all.changed, update.changed);
      all.resynced |= update.resynced;
      all.server_lost |= update.server_lost;
    }
    return all;
  }
};

/// One who has joined.
struct JoinedClient : OneClient {
  void SetUp() override { run(4); }
};

TEST_F(OneClient, JoinsSeveralUsersOverOneChannel) {
  const LocalUser b = client->add_user("b", "bot");
  EXPECT_EQ(client->send(a, PartId{1}, Vec3::Zero()), 0u);  // not yet
  EXPECT_EQ(client->statistics().not_joined, 1u);
  const ClientUpdate update = run(4);
  EXPECT_EQ(update.joined, (std::vector<LocalUser>{a, b}));
  EXPECT_NE(client->user_id(a), client->user_id(b));
  EXPECT_TRUE(client->synced());
  EXPECT_EQ(client->find_part("part3"), PartId{3});
  EXPECT_EQ(client->send(a, PartId{1}, Vec3(1, 0, 0)), 1u);
  EXPECT_EQ(client->send(b, PartId{2}, Vec3(0, 2, 0)), 1u);  // own numbers for each
  EXPECT_EQ(client->send(a, PartId{1}, Vec3(1, 0, 0)), 2u);
  const ClientUpdate moved = run(2);
  EXPECT_EQ(client->parts().at(PartId{1}).info.X_WP.p, Vec3(2, 0, 0));
  EXPECT_EQ(client->parts().at(PartId{2}).info.holder, client->user_id(b));
  ASSERT_EQ(moved.latency_ms.size(), 3u);
  EXPECT_DOUBLE_EQ(moved.latency_ms[0], 10.0);
  EXPECT_EQ(moved.changed, (std::vector<PartId>{PartId{1}, PartId{2}}));
}

TEST_F(OneClient, JoinIsAskedAgainWithTheSameNonce) {
  bench.answer_joins = false;
  run(150);
  EXPECT_EQ(bench.joins, 2u);  // once a second
  EXPECT_EQ(bench.users.size(), 1u);
  bench.answer_joins = true;
  run(100);
  EXPECT_EQ(client->join_state(0), JoinState::kJoined);
}

TEST_F(OneClient, RefusedJoinIsSaid) {
  bench.answer_joins = false;
  run(2);
  bench.server->publish_join_reply(
      {bench.hub.last_client(), 1, UserId{}, Refusal::kSessionFull, "session is full"});
  run(2);
  EXPECT_EQ(client->join_state(0), JoinState::kRefused);
  EXPECT_EQ(client->refusal_text(0), "session is full");
}

TEST_F(JoinedClient, DuplicatesAreDroppedAndGapsAreRepaired) {
  const ClashEvent e1 = bench.next_event(ClashEvent::Kind::kBegin, 1);
  bench.say(e1);
  bench.say(e1);
  EXPECT_EQ(run(2).events.size(), 1u);
  EXPECT_EQ(client->statistics().events_duplicate, 1u);
  // 3 before 2: applied in order, nothing asked for.
  const ClashEvent e2 = bench.next_event(ClashEvent::Kind::kBegin, 2);
  const ClashEvent e3 = bench.next_event(ClashEvent::Kind::kEnd, 1);
  bench.say(e3);
  EXPECT_TRUE(run(2).events.empty());
  bench.say(e2);
  const ClientUpdate update = run(2);
  ASSERT_EQ(update.events.size(), 2u);
  EXPECT_EQ(update.events[0].seq, 2u);
  EXPECT_EQ(client->open_clashes().size(), 1u);
  EXPECT_EQ(client->statistics().gaps, 0u);
  EXPECT_EQ(bench.requests, 0u);
  // 4 is lost for good: after a while a snapshot is asked for, and takes its place.
  bench.next_event(ClashEvent::Kind::kBegin, 7);
  bench.say(bench.next_event(ClashEvent::Kind::kBegin, 8));
  const ClientUpdate repaired = run(60);
  EXPECT_TRUE(repaired.resynced);
  EXPECT_EQ(bench.requests, 1u);
  EXPECT_EQ(client->statistics().gaps, 1u);
  EXPECT_EQ(client->statistics().events_skipped, 2u);
  EXPECT_TRUE(client->synced());
  EXPECT_EQ(client->open_clashes().size(), 3u);
  bench.say(bench.next_event(ClashEvent::Kind::kEnd, 8));
  EXPECT_EQ(run(2).events.size(), 1u);  // and the stream goes on
}

TEST_F(JoinedClient, SnapshotThatOvertakesItsEventsHidesNone) {
  const ClashEvent e1 = bench.next_event(ClashEvent::Kind::kBegin, 1);
  const ClashEvent e2 = bench.next_event(ClashEvent::Kind::kEnd, 1);
  bench.server->publish_snapshot(bench.snapshot());
  ClientUpdate update = run(3);
  EXPECT_FALSE(update.resynced);
  bench.say(e1);
  bench.say(e2);
  update = run(40);
  EXPECT_EQ(update.events.size(), 2u);
  EXPECT_FALSE(update.resynced);
  EXPECT_EQ(client->statistics().events_skipped, 0u);
  EXPECT_EQ(bench.requests, 0u);
}

TEST_F(JoinedClient, LostTailIsNoticedByThePoses) {
  bench.next_event(ClashEvent::Kind::kBegin, 1);  // never said
  client->send(0, PartId{1}, Vec3(1, 0, 0));      // but the pose batch knows of it
  run(60);
  EXPECT_EQ(client->open_clashes().size(), 1u);
  EXPECT_EQ(client->statistics().gaps, 1u);
}

TEST_F(JoinedClient, OldPosesDoNotOverwriteNewOnes) {
  PoseBatch batch;
  batch.tick = 100;
  batch.parts = {{PartId{1}, UserId{}, Pose::translation(Vec3(5, 0, 0))}};
  bench.server->publish_poses(batch);
  client->poll();
  batch.tick = 99;
  batch.parts[0].X_WP.p = Vec3(4, 0, 0);
  bench.server->publish_poses(batch);
  client->poll();
  EXPECT_EQ(client->parts().at(PartId{1}).info.X_WP.p, Vec3(5, 0, 0));
  EXPECT_EQ(client->statistics().poses_stale, 1u);
  bench.server->publish_snapshot(bench.snapshot());  // of an older tick
  client->poll();
  EXPECT_EQ(client->parts().at(PartId{1}).info.X_WP.p, Vec3(5, 0, 0));
}

TEST_F(JoinedClient, RejoinsARestartedServer) {
  bench.say(bench.next_event(ClashEvent::Kind::kBegin, 1));
  run(2);
  EXPECT_EQ(client->open_clashes().size(), 1u);
  bench.restart();
  const ClientUpdate update = run(10);
  EXPECT_TRUE(update.server_lost);
  EXPECT_EQ(update.joined.size(), 1u);
  EXPECT_EQ(client->join_state(0), JoinState::kJoined);
  EXPECT_TRUE(client->synced());
  EXPECT_TRUE(client->open_clashes().empty());
  bench.say(bench.next_event(ClashEvent::Kind::kBegin, 3));  // numbers start anew
  EXPECT_EQ(run(2).events.size(), 1u);
  EXPECT_EQ(client->statistics().server_losses, 1u);
}

TEST_F(JoinedClient, JoinsAgainWhenTakenForGone) {
  const UserId id = client->user_id(0);
  // The server says so in a snapshot ...
  bench.gone.insert(id);
  bench.server->publish_snapshot(bench.snapshot());
  run(150);
  EXPECT_FALSE(bench.gone.contains(id));
  EXPECT_EQ(bench.joins, 2u);
  // ... or in nothing but silence.
  bench.gone.insert(id);
  for (int i = 0; i < 350; ++i) {
    client->send(0, PartId{1}, Vec3(1, 0, 0));
    run(1);
  }
  EXPECT_FALSE(bench.gone.contains(id));
  EXPECT_EQ(bench.joins, 3u);
}

// A server that kept what it had to say until it might: of whoever was this user before.
TEST_F(JoinedClient, TakesNoAcknowledgementOfWhatItNeverSent) {
  const UserId id = client->user_id(0);
  client->send(0, PartId{1}, Vec3(1, 0, 0));
  PoseBatch late;
  late.tick = bench.tick;
  late.acks.push_back({id, 500, 0});
  bench.server->publish_poses(late);
  const ClientUpdate update = run(10);
  ASSERT_EQ(update.acks.size(), 1u);
  EXPECT_EQ(update.acks.front().seq, 1u);
}

// Of these a later acknowledgement says nothing: they are not repeated any more.
TEST_F(JoinedClient, SaysWhatItGaveUp) {
  const UserId id = client->user_id(0);
  bench.gone.insert(id);  // nothing is taken
  for (std::size_t i = 0; i < kMaxKeptIncrements + 3; ++i)
    client->send(0, PartId{1}, Vec3(1, 0, 0));
  ClientUpdate update = run(1);
  ASSERT_EQ(update.given_up.size(), 1u);
  EXPECT_EQ(update.given_up.front().seq, 3u);
  EXPECT_TRUE(run(1).given_up.empty()) << "said once";
  bench.restart();
  update = run(10);
  ASSERT_EQ(update.given_up.size(), 1u) << "another server knows none of them";
  EXPECT_EQ(update.given_up.front().seq, kMaxKeptIncrements + 3);
}

TEST_F(OneClient, HeartbeatsGoWhileNothingElseDoes) {
  client->add_user("b", "bot");
  run(4);
  std::size_t beats = 0;
  for (int i = 0; i < 100; ++i) {
    run(1);
    beats += bench.input.heartbeats.size();
  }
  EXPECT_EQ(beats, 10u);  // two users, five a second
  client->leave(0);
  run(1);
  EXPECT_EQ(bench.input.lost.size(), 1u);
  EXPECT_TRUE(bench.input.lost[0].said_goodbye);
}

TEST_F(OneClient, HeartbeatsOfItsUsersGoTogether) {
  run(4);
  client->add_user("b", "bot");  // joins while the first one is in
  run(7);
  std::size_t beats = 0, ticks = 0;
  for (int i = 0; i < 100; ++i) {
    run(1);
    beats += bench.input.heartbeats.size();
    ticks += bench.input.heartbeats.empty() ? 0 : 1;
  }
  EXPECT_GE(beats, 10u);
  EXPECT_LE(ticks, 6u) << "at first they may go apart";
}

// Anything may happen to poses and events: in the end all clients know the same, and what each was
// told is one stream without repeat, in order.
TEST(Client, ConvergesUnderLossDelayRepeatAndReorder) {
  for (const std::uint64_t seed : {11u, 12u, 13u, 14u}) {
    SCOPED_TRACE(seed);
    const MemoryFaults bad{0.1, 0.1, 0.2, 5, seed};
    Bench bench(bad, bad);
    std::vector<std::unique_ptr<ClientChannel>> channels;
    std::vector<std::unique_ptr<Client>> clients;
    for (int i = 0; i < 3; ++i) {
      channels.push_back(bench.hub.open_client());
      clients.push_back(bench.client(*channels.back()));
      clients.back()->add_user("user" + std::to_string(i), "bot");
    }
    std::mt19937_64 random(seed);
    std::vector<std::uint64_t> last(3, 0);
    std::uint64_t told = 0;
    const auto turn = [&] {
      bench.turn();
      for (std::size_t i = 0; i < 3; ++i) {
        const ClientUpdate update = clients[i]->poll();
        for (const ClashEvent& event : update.events) {
          ASSERT_GT(event.seq, last[i]);
          last[i] = event.seq;
          ++told;
        }
      }
    };
    for (int step = 0; step < 600; ++step) {
      for (std::size_t i = 0; i < 3; ++i) {
        clients[i]->send(0, PartId{1 + static_cast<std::uint32_t>(i)}, Vec3(0.25, 0, 0));
      }
      if (random() % 3 == 0) {
        const auto clash = static_cast<std::uint32_t>(1 + random() % 9);
        const bool is_open = bench.open.contains(ClashId{clash});
        bench.say(bench.next_event(
            is_open ? (random() % 2 == 0 ? ClashEvent::Kind::kEnd : ClashEvent::Kind::kChange)
                    : ClashEvent::Kind::kBegin,
            clash));
      }
      turn();
    }
    for (int step = 0; step < 400; ++step) turn();  // quiet: everything is repaired
    for (std::size_t i = 0; i < 3; ++i) {
      const Client& client = *clients[i];
      EXPECT_TRUE(client.synced());
      EXPECT_EQ(client.statistics().highest_event_seq, bench.event_seq);
      ASSERT_EQ(client.open_clashes().size(), bench.open.size());
      for (const auto& [id, clash] : bench.open) {
        EXPECT_EQ(client.open_clashes().at(id).seq, clash.seq);
      }
      for (const auto& [id, pose] : bench.parts) {
        EXPECT_EQ(client.parts().at(id).info.X_WP.p, pose.p);
      }
      EXPECT_GT(client.statistics().gaps, 0u);
      EXPECT_GT(client.statistics().events_duplicate, 0u);
    }
    EXPECT_GT(told, 100u);
  }
}

}  // namespace
}  // namespace mortise
