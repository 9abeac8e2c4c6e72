#include "common/messages/memory_channel.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace mortise {
namespace {

Increment increment_of(std::uint64_t seq) {
  Increment increment;
  increment.user = UserId{1};
  increment.part = PartId{1};
  increment.seq = seq;
  return increment;
}

std::vector<std::uint64_t> sent_through(const MemoryFaults& faults, int count) {
  MemoryHub hub(faults);
  auto server = hub.open_server();
  auto client = hub.open_client();
  std::vector<std::uint64_t> arrived;
  for (int i = 0; i < count + 50; ++i) {
    if (i < count) client->send(batch_of(increment_of(static_cast<std::uint64_t>(i) + 1), 0));
    for (const ReceivedIncrement& got : server->take().increments) {
      arrived.push_back(got.increment.seq);
    }
  }
  return arrived;
}

TEST(MemoryChannel, WithoutFaultsEverythingArrivesOnceInOrder) {
  const std::vector<std::uint64_t> arrived = sent_through({}, 100);
  ASSERT_EQ(arrived.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(arrived[i], i + 1);
}

TEST(MemoryChannel, FaultsStrikeAsOftenAsAskedFor) {
  EXPECT_NEAR(static_cast<double>(sent_through({0.3, 0, 0, 0, 5}, 10'000).size()), 7000, 200);
  EXPECT_NEAR(static_cast<double>(sent_through({0, 0.3, 0, 0, 5}, 10'000).size()), 13'000, 200);
  const std::vector<std::uint64_t> late = sent_through({0, 0, 0, 4, 5}, 1000);
  EXPECT_EQ(late.size(), 1000u);
  EXPECT_FALSE(std::is_sorted(late.begin(), late.end()));
}

TEST(MemoryChannel, TheSameSeedMeetsTheSameFaults) {
  const MemoryFaults faults{0.2, 0.1, 0.3, 3, 42};
  EXPECT_EQ(sent_through(faults, 500), sent_through(faults, 500));
  MemoryFaults other = faults;
  other.seed = 43;
  EXPECT_NE(sent_through(faults, 500), sent_through(other, 500));
}

TEST(MemoryChannel, OnlyTheOwnerSpeaksForAUser) {
  MemoryHub hub;
  auto server = hub.open_server();
  auto a = hub.open_client();
  const ClientKey key_a = hub.last_client();
  auto b = hub.open_client();
  server->publish_join_reply({key_a, 1, UserId{1}, Refusal::kNone, ""});
  a->heartbeat(UserId{1});
  b->heartbeat(UserId{1});
  b->leave(UserId{1});
  const ServerInput input = server->take();
  EXPECT_EQ(input.heartbeats.size(), 1u);
  EXPECT_TRUE(input.lost.empty());
  EXPECT_EQ(server->counters().foreign, 2u);
  EXPECT_EQ(a->take().join_replies.size(), 1u);
  EXPECT_TRUE(b->take().join_replies.empty());
}

TEST(MemoryChannel, LateJoinerGetsWhatWasKept) {
  MemoryHub hub;
  auto server = hub.open_server();
  EXPECT_FALSE(server->has_readers());
  Snapshot snapshot;
  snapshot.event_seq = 5;
  server->publish_snapshot(snapshot);
  const std::vector<std::byte> bytes(10, std::byte{7});
  server->publish_mesh("abc", bytes);
  server->publish_poses({});
  auto late = hub.open_client();
  EXPECT_TRUE(server->has_readers());
  const ClientInput input = late->take();
  ASSERT_EQ(input.snapshots.size(), 1u);
  EXPECT_EQ(input.snapshots[0].event_seq, 5u);
  ASSERT_EQ(input.meshes.size(), 1u);
  EXPECT_EQ(input.meshes[0].bytes, bytes);
  EXPECT_TRUE(input.poses.empty());
  EXPECT_TRUE(input.server_present);
}

TEST(MemoryChannel, KilledClientsAndRestartedServersAreNoticed) {
  MemoryHub hub;
  auto server = hub.open_server();
  auto a = hub.open_client();
  hub.kill(hub.last_client());
  a->join(1, "a", "bot");  // nobody hears a dead process
  ServerInput input = server->take();
  ASSERT_EQ(input.lost.size(), 1u);
  EXPECT_FALSE(input.lost[0].said_goodbye);
  EXPECT_TRUE(input.joins.empty());
  auto b = hub.open_client();
  server = hub.open_server();
  const ClientInput seen = b->take();
  EXPECT_TRUE(seen.server_lost);
  EXPECT_TRUE(seen.server_present);
  EXPECT_FALSE(b->take().server_lost);
  b.reset();
  EXPECT_EQ(server->take().lost.size(), 1u);
}

}  // namespace
}  // namespace mortise
