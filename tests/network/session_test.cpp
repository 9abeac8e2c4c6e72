// A session over real DDS on loopback: several participants, each over UDP.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>

#include "client/client.h"
#include "tests/network/domain.h"
#include "tests/network/small_server.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

/// A server and clients of this test's own domain, turned in this thread.
struct Session {
  explicit Session(std::uint32_t parts = 3, const std::string& name = "test", double lease_s = 0.0)
      : options(own_options(name)) {
    if (lease_s > 0.0) options.liveliness_lease_s = options.participant_lease_s = lease_s;
    auto opened = open_server_channel(options);
    if (!opened) throw std::runtime_error(opened.error().text);
    channel = std::move(*opened);
    server = std::make_unique<SmallServer>(*channel, name, parts);
  }
  Client& add_client(const std::string& name) {
    auto opened = open_client_channel(options);
    if (!opened) throw std::runtime_error(opened.error().text);
    channels.push_back(std::move(*opened));
    clients.push_back(std::make_unique<Client>(*channels.back()));
    events.emplace_back();
    clients.back()->add_user(name, "designer");
    return *clients.back();
  }
  void turn() {
    server->turn();
    for (std::size_t i = 0; i < clients.size(); ++i) {
      const ClientUpdate update = clients[i]->poll();
      for (const ClashEvent& event : update.events) events[i].push_back(event);
      refused += update.refused.size();
      for (const double ms : update.latency_ms) latency_ms.push_back(ms);
    }
  }
  bool wait(double limit_s, const std::function<bool()>& done) {
    return until(limit_s, done, [this] { turn(); });
  }
  bool all_joined() const {
    for (const auto& client : clients) {
      if (client->join_state(0) != JoinState::kJoined || !client->synced()) return false;
    }
    return true;
  }

  DdsOptions options;
  std::unique_ptr<ServerChannel> channel;
  std::unique_ptr<SmallServer> server;
  std::vector<std::unique_ptr<ClientChannel>> channels;
  std::vector<std::unique_ptr<Client>> clients;
  std::vector<std::vector<ClashEvent>> events;
  std::vector<double> latency_ms;
  std::size_t refused = 0;
};

TEST(Network, JoinsMovesAndSeesPoses) {
  Session session;
  Client& a = session.add_client("anna");
  Client& b = session.add_client("bert");
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  EXPECT_NE(a.user_id(0), b.user_id(0));
  EXPECT_EQ(a.session(), "test");
  EXPECT_EQ(a.find_part("part2"), PartId{2});
  a.grab(0, PartId{1});
  for (int i = 0; i < 20; ++i) {
    a.send(0, PartId{1}, Vec3(0, 0.5, 0));
    session.turn();
  }
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    for (const Client* client : {&a, &b}) {
      const PartInfo& part = client->parts().at(PartId{1}).info;
      if (part.X_WP.p.y() != 10.0 || !part.holder) return false;
    }
    return !session.latency_ms.empty();
  }));
  EXPECT_EQ(b.parts().at(PartId{1}).info.holder, a.user_id(0));
  EXPECT_EQ(a.parts().at(PartId{1}).info.X_WP.p, Vec3(1, 10, 0));
  EXPECT_GT(session.latency_ms.front(), 0.0);
  EXPECT_EQ(session.channel->counters().malformed, 0u);
  EXPECT_EQ(session.channel->counters().send_failed, 0u);
}

/// Also who has not joined yet is woken: by a server that comes.
TEST(Network, NewsEndAWait) {
  constexpr double kLong_s = 60.0;
  Session session;
  Client& anna = session.add_client("anna");
  const auto await = [&] { session.channels.front()->await_input(60'000'000'000); };
  const double begun_s = now_s();
  while (!anna.server_present() && now_s() < begun_s + kLong_s) {
    await();
    anna.poll();
  }
  if (timed()) {
    EXPECT_LT(now_s(), begun_s + kLong_s / 2) << "until a server was there";
  }
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  while (anna.statistics().highest_event_seq < 20) {
    session.server->publish_events(1);
    await();
    anna.poll();
  }
  if (timed()) {
    EXPECT_LT(now_s(), begun_s + kLong_s / 2) << "with twenty events";
  }
}

TEST(Network, AServerIsFoundByTheNameOfItsHost) {
  Session session;
  session.options.server = "localhost,127.0.0.1";
  session.add_client("anna");
  EXPECT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
}

TEST(Network, FourClientsSeeTheSameEventsInTheSameOrder) {
  Session session;
  for (const char* name : {"a", "b", "c", "d"}) session.add_client(name);
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  for (int i = 0; i < 100; ++i) {
    session.server->publish_events(1 + static_cast<std::uint32_t>(i) % 5);
    session.turn();
  }
  session.server->publish_events(500);  // several samples at once
  const std::uint64_t last = session.server->event_seq;
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    for (const auto& client : session.clients) {
      if (client->statistics().highest_event_seq < last) return false;
    }
    return true;
  }));
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(session.events[i].size(), last) << "client " << i;
    for (std::uint64_t k = 0; k < last; ++k) {
      ASSERT_EQ(session.events[i][k].seq, k + 1);
      ASSERT_EQ(session.events[i][k].verdict.explanation, "event " + std::to_string(k + 1));
    }
    EXPECT_EQ(session.clients[i]->statistics().gaps, 0u);
  }
}

TEST(Network, LateJoinerGetsTheSnapshotAndGoesOnWithoutAGap) {
  Session session(200);
  session.add_client("first");
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  for (int i = 0; i < 50; ++i) {
    session.server->publish_events(2);
    session.turn();
  }
  Client& late = session.add_client("late");
  // Events go on while it joins.
  double next_s = now_s();
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    if (now_s() > next_s) {
      session.server->publish_events(1);
      next_s += 0.02;
    }
    return session.all_joined();
  }));
  EXPECT_EQ(late.parts().size(), 200u);
  for (int i = 0; i < 20; ++i) {
    session.server->publish_events(1);
    session.turn();
  }
  const std::uint64_t last = session.server->event_seq;
  ASSERT_TRUE(
      session.wait(kPatience_s, [&] { return late.statistics().highest_event_seq == last; }));
  ASSERT_GE(session.events[1].size(), 20u);
  EXPECT_LT(session.events[1].size(), last);  // what the snapshot covers is not repeated
  for (std::size_t k = 1; k < session.events[1].size(); ++k) {
    ASSERT_EQ(session.events[1][k].seq, session.events[1][k - 1].seq + 1);
  }
}

TEST(Network, ManyKeysAreNotLost) {
  constexpr std::uint32_t kUsers = 200, kParts = 200;
  Session session(kParts);
  Client& bots = session.add_client("bot0");
  for (std::uint32_t i = 1; i < kUsers; ++i) bots.add_user("bot" + std::to_string(i), "bot");
  const auto joined = [&] {
    for (std::uint32_t i = 0; i < kUsers; ++i) {
      if (bots.join_state(i) != JoinState::kJoined) return false;
    }
    return bots.synced();
  };
  ASSERT_TRUE(session.wait(kPatience_s, joined));
  for (std::uint32_t i = 0; i < kUsers; ++i) bots.send(i, PartId{i + 1}, Vec3(0, 0, 1));
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.server->increments == kUsers; }))
      << session.server->increments;
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    for (const auto& [id, part] : bots.parts()) {
      if (part.info.X_WP.p.z() != 1.0) return false;
    }
    return true;
  }));
  EXPECT_EQ(session.channels[0]->counters().send_failed, 0u);
}

TEST(Network, LargeSnapshotsAndMeshesArriveWhole) {
  Session session(2000);  // far beyond one datagram
  std::vector<std::byte> mesh(1'500'000);
  for (std::size_t i = 0; i < mesh.size(); ++i) mesh[i] = static_cast<std::byte>(i * 7 + i / 251);
  session.channel->publish_mesh("00112233445566778899aabbccddeeff", mesh);
  FeatureTable features;
  FeatureSet& set = features.sets.emplace_back();
  for (std::uint32_t i = 1; i <= 2000; ++i) set.parts.push_back(PartId{i});
  for (int i = 0; i < 700; ++i) {
    FeatureInfo bore;
    bore.name = "bore_" + std::to_string(i);
    bore.origin = FeatureOrigin::kRecognized;
    bore.kind = SurfaceKind::kCylinder;
    bore.radius_mm = i;
    set.features.push_back(bore);
  }
  session.channel->publish_features(features);
  auto opened = open_client_channel(session.options);
  ASSERT_TRUE(opened) << opened.error().text;
  Client client(**opened);
  std::vector<MeshBytes> meshes;
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    ClientUpdate update = client.poll();
    for (MeshBytes& one : update.meshes) meshes.push_back(std::move(one));
    return client.parts().size() == 2000 && !meshes.empty() && client.features().told();
  }));
  EXPECT_EQ(client.features().of(PartId{2000}).size(), 700u);
  ASSERT_NE(client.features().find(PartId{1}, "bore_699"), nullptr);
  EXPECT_EQ(client.features().find(PartId{1}, "bore_699")->radius_mm, 699.0);
  EXPECT_EQ(meshes[0].hash, "00112233445566778899aabbccddeeff");
  EXPECT_EQ(meshes[0].bytes, mesh);
  EXPECT_EQ(client.find_part("part2000"), PartId{2000});
}

TEST(Network, RefusesAtTheDoorAndForForeignUsers) {
  Session session;
  Client& a = session.add_client("anna");
  Client& b = session.add_client("bert");
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  a.send(0, PartId{1}, Vec3(std::nan(""), 0, 0));
  a.send(0, PartId{1}, Vec3::Zero(), Vec3(0, 4, 0));
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.refused == 2; }));
  EXPECT_EQ(session.server->increments, 0u);
  EXPECT_EQ(session.channel->counters().malformed, 2u);
  // Bert says that he is Anna, and she says so between.
  constexpr std::uint64_t kForged = 5;
  for (std::uint64_t i = 0; i < kForged; ++i) {
    session.channels[1]->heartbeat(a.user_id(0));
    session.channels[0]->heartbeat(a.user_id(0));
  }
  session.channels[1]->leave(a.user_id(0));
  Increment stolen;
  stolen.user = a.user_id(0);
  stolen.part = PartId{1};
  stolen.seq = 99;
  stolen.translation_mm = Vec3(1, 0, 0);
  session.channels[1]->send(batch_of(stolen, 0));
  ClientKey key;
  ASSERT_TRUE(session.wait(kPatience_s, [&] {
    for (const auto& received : session.server->last_input.increments) key = received.client;
    return !key.empty() && session.channel->counters().foreign >= kForged;
  }));
  EXPECT_EQ(key, session.server->users.at(b.user_id(0)).first);  // the true sender is told
  EXPECT_NE(key, session.server->users.at(a.user_id(0)).first);
  EXPECT_TRUE(session.server->lost.empty());
  // A name that no log should hold.
  session.channels[1]->join(77, "line\nbreak", "designer");
  session.channels[1]->join(78, "carl", "emperor");
  std::size_t refusals = 0;
  until(
      3.0, [&] { return refusals == 1; },
      [&] {
        session.server->turn();
        for (const JoinReply& reply : session.channels[1]->take().join_replies) {
          refusals += reply.nonce == 78 && reply.refusal == Refusal::kNotAllowed;
        }
      });
  EXPECT_EQ(refusals, 1u);
}

TEST(Network, WhoClosesIsGoneBeforeALeaseRunsOut) {
  Session session(3, "test", 60.0);
  session.add_client("anna");
  session.add_client("bert");
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  const ClientKey key = session.server->users.at(session.clients[1]->user_id(0)).first;
  session.clients.pop_back();
  session.channels.pop_back();  // without a goodbye
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return !session.server->lost.empty(); }));
  EXPECT_EQ(session.server->lost[0].client, key);
}

TEST(Network, NothingThatAServerSaidLastComesAfterItsLoss) {
  Session session;
  Client& client = session.add_client("anna");
  ASSERT_TRUE(session.wait(kPatience_s, [&] { return session.all_joined(); }));
  for (int round = 0; round < 5; ++round) {
    int resynced_after = 0;
    bool lost = false;
    std::uint64_t highest_event = 0;
    std::atomic<bool> ended = false;
    std::thread reader([&] {
      while (!ended) {
        const ClientUpdate update = client.poll();
        lost = lost || update.server_lost;
        resynced_after += lost && update.resynced;
        if (!lost) highest_event = client.statistics().highest_event_seq;
        sleep_s(0.001);
      }
    });
    session.server->publish_events(1);
    session.channel->publish_snapshot(session.server->snapshot());
    const std::uint64_t last_event = session.server->event_seq;
    session.channel.reset();
    sleep_s(0.5);
    ended = true;
    reader.join();
    EXPECT_TRUE(lost);
    EXPECT_EQ(resynced_after, 0);
    EXPECT_EQ(highest_event, last_event);
    auto again = open_server_channel(session.options);
    ASSERT_TRUE(again) << again.error().text;
    session.channel = std::move(*again);
    session.server = std::make_unique<SmallServer>(*session.channel, "test", 3);
    ASSERT_TRUE(
        session.wait(kPatience_s, [&] { return client.server_present() && session.all_joined(); }));
  }
}

TEST(Network, WhoIsGoneBeforeItsJoinIsReadDoesNotGetIn) {
  Session session;
  auto channel = open_client_channel(session.options);
  ASSERT_TRUE(channel) << channel.error().text;
  ASSERT_TRUE(until(
      kPatience_s, [&] { return (*channel)->take().server_present; }, [] {}));
  (*channel)->join(1, "hasty", "bot");
  sleep_s(0.3);
  channel->reset();
  sleep_s(0.3);
  until(
      1.0, [] { return false; }, [&] { session.turn(); });
  EXPECT_TRUE(session.server->users.empty());
}

TEST(Network, OpeningFailsInOneLine) {
  DdsOptions options = own_options();
  auto first = open_server_channel(options);
  ASSERT_TRUE(first) << first.error().text;
  auto second = open_server_channel(options);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().text.find("in use"), std::string::npos) << second.error().text;
  EXPECT_EQ(second.error().text.find('\n'), std::string::npos);
  // Another port of the same domain: both live.
  DdsOptions beside = options;
  beside.discovery_port = 7400 + 250 * options.domain + 4;
  auto third = open_server_channel(beside);
  EXPECT_TRUE(third) << third.error().text;

  DdsOptions bad = options;
  bad.domain = 233;
  EXPECT_NE(open_client_channel(bad).error().text.find("domain 233"), std::string::npos);
  bad = options;
  bad.interface = "203.0.113.9";  // documentation range: nobody has it
  EXPECT_NE(open_client_channel(bad).error().text.find("203.0.113.9"), std::string::npos);
  bad = options;
  bad.server = "127.0.0.1,nobody.invalid";  // RFC 2606: no host has such a name
  EXPECT_NE(open_client_channel(bad).error().text.find("'nobody.invalid' is neither an IPv4"),
            std::string::npos);
  bad = options;
  bad.session = "*";
  EXPECT_FALSE(open_client_channel(bad));
  bad = options;
  bad.participant_lease_s = 0.3;
  EXPECT_FALSE(open_server_channel(bad));
}

}  // namespace
}  // namespace mortise::test
