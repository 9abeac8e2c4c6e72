#include "idl/chunks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "idl/topics.h"
#include "tests/unit/idl/samples.h"

namespace mortise {
namespace {

template <class Type, class Sample>
std::size_t serialized_size(const Sample& sample) {
  Type type;
  Sample copy = sample;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(1 << 20);
  return type.serialize(&copy, &payload) ? payload.length : 0;
}

Snapshot large_snapshot() {
  Snapshot snapshot;
  snapshot.session = "large";
  snapshot.event_seq = 77;
  for (std::uint32_t i = 1; i <= 1500; ++i) {
    PartInfo part;
    part.part = PartId{i};
    part.name = std::string(i % 60, 'p');
    part.mesh_hash = std::string(32, 'a');
    snapshot.parts.push_back(part);
  }
  for (std::uint32_t i = 1; i <= 300; ++i) snapshot.users.push_back({UserId{i}, "user", true});
  for (std::uint64_t i = 1; i <= 400; ++i) snapshot.open_clashes.push_back(test::some_clash(i));
  return snapshot;
}

TEST(Chunks, EverySampleFitsADatagram) {
  const std::vector<wire::Snapshot> chunks = cut(large_snapshot(), 3);
  EXPECT_GT(chunks.size(), 4u);
  std::size_t parts = 0, users = 0, clashes = 0, largest = 0;
  for (const wire::Snapshot& chunk : chunks) {
    largest = std::max(largest, serialized_size<wire::SnapshotPubSubType>(chunk));
    EXPECT_EQ(chunk.count(), chunks.size());
    EXPECT_EQ(chunk.event_seq(), 77u);
    parts += chunk.parts().size();
    users += chunk.users().size();
    clashes += chunk.open_clashes().size();
  }
  EXPECT_LE(largest, kSampleLimit_bytes);
  EXPECT_GT(largest, kSampleLimit_bytes * 9 / 10);  // and they are filled
  EXPECT_EQ(parts, 1500u);
  EXPECT_EQ(users, 300u);
  EXPECT_EQ(clashes, 400u);

  PoseBatch batch;
  std::mt19937_64 random(3);
  for (int i = 0; i < 3000; ++i) batch.parts.push_back(test::some_pose(random));
  const std::vector<wire::PoseBatch> poses = cut(batch, 10);
  EXPECT_GT(poses.size(), 2u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LE(serialized_size<wire::PoseBatchPubSubType>(poses[i]), kSampleLimit_bytes);
    EXPECT_EQ(poses[i].serial(), 10 + i);  // each is counted
  }
  std::vector<ClashEvent> events(1000, test::some_clash());
  for (const wire::EventBatch& events_chunk : cut(events)) {
    EXPECT_LE(serialized_size<wire::EventBatchPubSubType>(events_chunk), kSampleLimit_bytes);
  }
  EXPECT_EQ(cut(Snapshot{}, 1).size(), 1u);  // nothing to say is said once
}

TEST(Chunks, SnapshotIsWholeInAnyOrderWithRepeats) {
  std::vector<wire::Snapshot> chunks = cut(large_snapshot(), 5);
  std::mt19937_64 random(17);
  for (int round = 0; round < 20; ++round) {
    std::vector<wire::Snapshot> sent = chunks;
    sent.push_back(chunks[random() % chunks.size()]);
    std::shuffle(sent.begin(), sent.end(), random);
    ChunkCollector<wire::Snapshot> collector;
    int whole = 0;
    for (const wire::Snapshot& chunk : sent) {
      const auto got = collector.add(chunk);
      if (!got) continue;
      ++whole;
      ASSERT_EQ(got->size(), chunks.size());
      for (std::size_t i = 0; i < got->size(); ++i) EXPECT_EQ((*got)[i].chunk(), i);
    }
    EXPECT_EQ(whole, 1);
  }
}

TEST(Chunks, NewerSnapshotTakesTheOldOnesPlace) {
  const std::vector<wire::Snapshot> old_chunks = cut(large_snapshot(), 5);
  const std::vector<wire::Snapshot> new_chunks = cut(large_snapshot(), 6);
  ChunkCollector<wire::Snapshot> collector;
  for (std::size_t i = 0; i + 1 < old_chunks.size(); ++i)
    EXPECT_FALSE(collector.add(old_chunks[i]));
  EXPECT_FALSE(collector.add(new_chunks[0]));
  EXPECT_FALSE(collector.add(old_chunks.back()));  // too late
  bool whole = false;
  for (std::size_t i = 1; i < new_chunks.size(); ++i)
    whole = collector.add(new_chunks[i]).has_value();
  EXPECT_TRUE(whole);
  wire::Snapshot bad = new_chunks[0];
  bad.serial(9);
  bad.count(1);
  bad.chunk(1);  // outside of its count
  EXPECT_FALSE(collector.add(bad));
  bad.chunk(0);
  bad.count(1'000'000'000);
  EXPECT_FALSE(collector.add(bad));
}

TEST(Chunks, MeshIsWholeOnceAndChecked) {
  std::vector<std::byte> bytes(200'000);
  std::mt19937_64 random(5);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  std::vector<wire::MeshChunk> chunks = cut_mesh("abc", bytes);
  EXPECT_GT(chunks.size(), 3u);
  for (const wire::MeshChunk& chunk : chunks) {
    EXPECT_LE(serialized_size<wire::MeshChunkPubSubType>(chunk), kSampleLimit_bytes);
  }
  std::reverse(chunks.begin(), chunks.end());
  MeshCollector collector;
  std::size_t whole = 0;
  for (int twice = 0; twice < 2; ++twice) {
    for (const wire::MeshChunk& chunk : chunks) {
      if (const auto mesh = collector.add(chunk)) {
        ++whole;
        EXPECT_EQ(mesh->hash, "abc");
        EXPECT_EQ(mesh->bytes, bytes);
      }
    }
  }
  EXPECT_EQ(whole, 1u);
  EXPECT_EQ(collector.refused(), 0u);
  // One wrong byte, and the mesh is not given out.
  MeshCollector other;
  chunks[1].bytes()[7] ^= 1;
  for (const wire::MeshChunk& chunk : chunks) EXPECT_FALSE(other.add(chunk));
  EXPECT_EQ(other.refused(), 1u);
  EXPECT_EQ(cut_mesh("empty", {}).size(), 1u);
}

ToldTick large_tick(std::uint64_t tick) {
  ToldTick told{tick, std::vector<std::byte>(200'000)};
  std::mt19937_64 random(tick);
  for (std::byte& byte : told.bytes) byte = static_cast<std::byte>(random());
  return told;
}

TEST(Chunks, ATickIsWholeWhereItsPiecesComeInOrder) {
  TickCollector collector;
  for (const std::uint64_t tick : {7, 8, 9}) {
    const ToldTick told = large_tick(tick);
    const std::vector<wire::ServerTick> pieces = cut(told, 3);
    ASSERT_EQ(pieces.size(), 4u);
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) EXPECT_FALSE(collector.add(pieces[i]));
    const std::optional<ToldTick> whole = collector.add(pieces.back());
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->tick, tick);
    EXPECT_EQ(whole->bytes, told.bytes);
  }
  ASSERT_TRUE(collector.add(cut(ToldTick{10, {}}, 3)[0])) << "one that says nothing";
  EXPECT_EQ(collector.dropped(), 0u);
}

TEST(Chunks, PiecesThatMakeNoTickAreDroppedAndCounted) {
  const std::vector<wire::ServerTick> seven = cut(large_tick(7), 3), eight = cut(large_tick(8), 3);
  const std::vector<wire::ServerTick> later = cut(large_tick(7), 4);
  const auto count_of = [](std::vector<wire::ServerTick> pieces) {
    TickCollector collector;
    for (const wire::ServerTick& piece : pieces) EXPECT_FALSE(collector.add(piece));
    // Whatever came before it: a tick that is whole is taken.
    const std::uint64_t dropped = collector.dropped();
    for (const wire::ServerTick& piece : cut(large_tick(9), 3)) {
      const auto whole = collector.add(piece);
      EXPECT_EQ(whole.has_value(), piece.chunk() == 3);
      if (whole) {
        EXPECT_EQ(whole->bytes, large_tick(9).bytes);
      }
    }
    return dropped;
  };
  EXPECT_EQ(count_of({seven[1], seven[2], seven[3]}), 3u) << "without a beginning";
  EXPECT_EQ(count_of({seven[0], seven[2], seven[3]}), 3u) << "with a hole";
  EXPECT_EQ(count_of({seven[0], seven[1], seven[1], seven[2]}), 4u) << "one twice";
  EXPECT_EQ(count_of({seven[0], eight[1], eight[2], eight[3]}), 4u) << "of two ticks";
  EXPECT_EQ(count_of({seven[0], later[1], later[2], later[3]}), 4u) << "of two servers";
  wire::ServerTick huge = seven[0];
  huge.count(1'000'000'000);
  EXPECT_EQ(count_of({huge}), 1u);
  huge.count(1);
  huge.bytes().resize(kSampleLimit_bytes + 1);
  EXPECT_EQ(count_of({huge}), 1u);
  huge.count(0);
  EXPECT_EQ(count_of({huge}), 1u);
  // Many that begin and never end: one at a time is kept.
  TickCollector collector;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(collector.add(seven[0]));
  EXPECT_EQ(collector.dropped(), 99u);
}

}  // namespace
}  // namespace mortise
