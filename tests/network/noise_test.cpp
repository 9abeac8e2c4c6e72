// Noise on the wire: mutated datagrams sent to a living server's ports. It must go on, and count.
#include <gtest/gtest.h>

#include <cstdio>

#include "client/client.h"
#include "tests/network/domain.h"
#include "tests/network/noise.h"
#include "tests/network/small_server.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

/// A DATA submessage to the reader of increments with a body of the caller's.
Datagram data_datagram(std::mt19937_64& random) {
  Datagram out = {'R', 'T', 'P', 'S', 2, 2,  1,    15, 1,  15, 1, 15, 1,  15,
                  1,   15,  1,   15,  1, 15, 0x15, 5,  60, 0,  0, 0,  16, 0};
  for (int i = 0; i < 8; ++i) out.push_back(static_cast<std::uint8_t>(random() % 8));  // entities
  for (const int byte : {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}) {
    out.push_back(static_cast<std::uint8_t>(byte));
  }
  while (out.size() < 84) out.push_back(static_cast<std::uint8_t>(random()));
  return out;
}

TEST(NetworkNoise, ServerAndClientsOutliveMutatedDatagrams) {
  const DdsOptions options = own_options();
  const int port = 7402 + 250 * options.domain;
  std::mt19937_64 random(31337);
  std::vector<Datagram> seeds;
  {  // What a client really says to a server that it looks for.
    Socket ear(port);
    ASSERT_TRUE(ear.bound());
    auto channel = open_client_channel(options);
    ASSERT_TRUE(channel) << channel.error().text;
    for (int i = 0; i < 8; ++i) {
      Datagram heard = ear.receive();
      if (!heard.empty()) seeds.push_back(std::move(heard));
    }
  }
  ASSERT_FALSE(seeds.empty());
  for (int i = 0; i < 4; ++i) seeds.push_back(data_datagram(random));

  // The server is a child: were it to die, this test says so and does not die with it.
  Child server("server", options, "noisy", effort(60));
  Child victim("client", options, "victim", effort(60));
  auto channel = open_client_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  Client client(**channel);
  client.add_user("anna", "designer");
  std::uint64_t events = 0;
  const auto turn = [&] { events += client.poll().events.size(); };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return client.join_state(0) == JoinState::kJoined; }, turn));
  const auto users = [&] { return client.users().size(); };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return users() == 2; }, turn))
      << "the victim has not joined";
  Socket mouth(0);
  // Half to the server's two ports, half to those that the first participants of a domain take: the
  // victim's, and this process's own.
  const int kDatagrams = effort(25'000);
  for (int i = 0; i < kDatagrams; ++i) {
    const int to = i % 2 == 0 ? port + static_cast<int>(random() % 2)
                              : port + 8 + static_cast<int>(random() % 6);
    mouth.send(mutate(seeds[random() % seeds.size()], random), to);
    if (i % 200 == 0) {
      turn();
      sleep_s(0.01);  // or the socket's buffer overflows, and nothing is tested
    }
  }
  std::printf("%d mutated datagrams; dropped by this process's guard: %llu\n", kDatagrams,
              static_cast<unsigned long long>((*channel)->counters().guard_dropped));
  EXPECT_GT((*channel)->counters().guard_dropped, 0u) << "the noise does not reach the clients";
  const std::uint64_t before = events;
  ASSERT_TRUE(until(
      kPatience_s, [&] { return events > before + 3; }, turn))
      << "the server is gone";
  EXPECT_EQ(server.wait(0.1), -1);  // still running
  EXPECT_EQ(victim.wait(0.1), -1);
  client.add_user("bert", "designer");
  EXPECT_TRUE(until(
      kPatience_s, [&] { return client.join_state(1) == JoinState::kJoined; }, turn));
}

TEST(NetworkNoise, DroppedDatagramsAreCounted) {
  const DdsOptions options = own_options();
  auto channel = open_server_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  Socket mouth(0);
  for (int i = 0; i < 100; ++i) {
    mouth.send(Datagram(64, static_cast<std::uint8_t>(i)), 7402 + 250 * options.domain);
  }
  EXPECT_TRUE(until(
      kPatience_s, [&] { return (*channel)->counters().guard_dropped >= 100; },
      [&] { (*channel)->take(); }))
      << (*channel)->counters().guard_dropped;
  // A server hears its own ticks; that the statistics which Fast DDS hangs on them are cut off is
  // counted apart.
  EXPECT_EQ((*channel)->counters().guard_dropped, 100U);
}

}  // namespace
}  // namespace mortise::test
