// What a session does when processes die, freeze and come back. Children are ended by their id.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "client/client.h"
#include "tests/network/domain.h"
#include "tests/network/frozen_reader.h"
#include "tests/network/small_server.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

TEST(NetworkFault, KilledClientIsNoticedWhileOthersLive) {
  const DdsOptions options = own_options();
  Child victim("client", options, "victim", 30.0);
  Child leaver("client", options, "leaver", 4.0);
  Child other("client", options, "other", 30.0);
  auto channel = open_server_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  SmallServer server(**channel, options.session, 3);
  ASSERT_TRUE(until(
      kPatience_s, [&] { return server.users.size() == 3; }, [&] { server.turn(); }));
  until(
      1.0, [] { return false; }, [&] { server.turn(); });  // heartbeats go
  ClientKey key, leaver_key;
  for (const auto& [id, user] : server.users) {
    if (user.second == "victim") key = user.first;
    if (user.second == "leaver") leaver_key = user.first;
  }
  victim.signal(SIGKILL);
  server.lost.clear();  // a busy machine may have starved somebody before
  const double killed_s = now_s();
  const auto of = [&](const ClientKey& client, bool said_goodbye) {
    return std::count_if(server.lost.begin(), server.lost.end(), [&](const LostUser& lost) {
      return lost.client == client && lost.said_goodbye == said_goodbye;
    });
  };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return of(key, false) > 0; }, [&] { server.turn(); }));
  const double noticed_s = now_s() - killed_s;
  const double ratio = noticed_s / options.liveliness_lease_s;
  std::printf("killed client of three noticed after %.3f s = %.2f leases\n", noticed_s, ratio);
  if (timed()) {
    EXPECT_LT(noticed_s, options.liveliness_lease_s + 0.5);
  }
  // Once only, though its participant's lease ends later; and the leaver says goodbye.
  ASSERT_TRUE(until(
      kPatience_s, [&] { return of(leaver_key, true) == 1; }, [&] { server.turn(); }));
  EXPECT_EQ(leaver.wait(kPatience_s), 0);
  until(
      1.0, [] { return false; }, [&] { server.turn(); });
  EXPECT_EQ(of(key, false), 1);
  EXPECT_EQ(of(key, true), 0);
}

TEST(NetworkFault, FrozenReaderDoesNotHoldUpTheServer) {
  const DdsOptions options = own_options();
  FrozenReader reader(options);
  ASSERT_TRUE(reader.both_joined());
  SmallServer& server = *reader.server;
  reader.healthy->grab(0, PartId{1});
  until(
      0.3, [] { return false; }, [&] { reader.turn(); });
  reader.stop();
  server.longest_publish_s = 0.0;
  server.slow_publishes = 0;
  // 2.5 s at 240 Hz: far more than any history holds.
  std::uint64_t turns = 0;
  const double start_s = now_s();
  while (now_s() - start_s < 2.5) {
    reader.busy_turn();
    ++turns;
    sleep_s(std::max(0.0, start_s + static_cast<double>(turns) / 240.0 - now_s()));
  }
  const double longest_ms = server.longest_publish_s * 1e3;
  std::printf(
      "frozen reader: %llu turns of 600, longest publish %.2f ms, slow ones %llu, failed %llu\n",
      static_cast<unsigned long long>(turns), longest_ms,
      static_cast<unsigned long long>(server.slow_publishes),
      static_cast<unsigned long long>(reader.channel->counters().send_failed));
  // A writer that waits for its reader waits at every publish once its history is full, and then
  // fails. A busy machine may take the processor away now and then, which is not that.
  if (timed()) {
    EXPECT_LT(server.slow_publishes, turns / 10);
    EXPECT_GE(turns, 300u);
  }
  EXPECT_EQ(reader.channel->counters().send_failed, 0u);
  ASSERT_TRUE(reader.all_heard());
  reader.go_on();
}

TEST(NetworkFault, KilledServerComesBackAndClientsJoinAgain) {
  const DdsOptions options = own_options();
  auto server = std::make_unique<Child>("server", options, "first", 30.0);
  auto channel = open_client_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  Client client(**channel);
  client.add_user("anna", "designer");
  std::size_t joined = 0, lost = 0;
  std::uint64_t last_seq = 0, first_seq_after = 0;
  const auto turn = [&] {
    const ClientUpdate update = client.poll();
    joined += update.joined.size();
    lost += update.server_lost;
    for (const ClashEvent& event : update.events) {
      if (lost > 0 && first_seq_after == 0) first_seq_after = event.seq;
      last_seq = event.seq;
    }
  };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return joined == 1 && last_seq > 3; }, turn));
  server->signal(SIGKILL);
  EXPECT_EQ(server->wait(kPatience_s), -1);  // its port is free again
  server = std::make_unique<Child>("server", options, "second", 30.0);
  const double restart_s = now_s();
  ASSERT_TRUE(until(
      kPatience_s, [&] { return joined == 2 && first_seq_after > 0; }, turn));
  const double gap_s = now_s() - restart_s;
  std::printf("server restarted: joined again, with data, after %.3f s\n", gap_s);
  EXPECT_EQ(lost, 1u);
  EXPECT_TRUE(client.synced());
  EXPECT_EQ(client.join_state(0), JoinState::kJoined);
}

TEST(NetworkFault, SixteenProcessesFindTheServer) {
  const DdsOptions options = own_options();
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < 16; ++i) {
    children.push_back(std::make_unique<Child>("client", options, "bot" + std::to_string(i), 20.0));
  }
  auto channel = open_server_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  SmallServer server(**channel, options.session, 3);
  const double start_s = now_s();
  ASSERT_TRUE(until(
      kPatience_s, [&] { return server.users.size() == 16; }, [&] { server.turn(); }))
      << server.users.size();
  std::printf("16 client processes joined after %.3f s\n", now_s() - start_s);
  // And all go on to be heard.
  std::set<UserId> heard;
  EXPECT_TRUE(until(
      kPatience_s, [&] { return heard.size() == 16; },
      [&] {
        server.turn();
        heard.insert(server.last_input.heartbeats.begin(), server.last_input.heartbeats.end());
      }));
}

}  // namespace
}  // namespace mortise::test
