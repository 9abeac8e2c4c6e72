#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <random>

#include "common/messages/channel.h"
#include "idl/convert.h"
#include "idl/safe_type.h"
#include "idl/wire_types.h"

namespace mortise::test {

Increment some_increment();
PartPose some_pose(std::mt19937_64& random);
ClashEvent some_clash(std::uint64_t seq = 4);
Request some_join();
wire::EventBatch some_event_batch();
wire::Snapshot some_snapshot_chunk();
Details some_details();
FeatureInfo some_feature();
void expect_same(const ClashEvent& a, const ClashEvent& b);

struct Fuzzed {
  std::size_t unreadable = 0;  ///< not a sample
  std::size_t counted = 0;     ///< of these, by SafeType
  std::size_t refused = 0;     ///< a sample that the door refuses
  std::size_t passed = 0;
};

/// Serializes a sample, mutates its bytes `count` times, reads them back and asks the door.
template <class Type, class Sample, class Door>
Fuzzed fuzz(Sample sample, int count, std::mt19937_64& random, Door door) {
  auto counter = std::make_shared<std::atomic<std::uint64_t>>(0);
  SafeType<Type> type(counter);
  eprosima::fastrtps::rtps::SerializedPayload_t good(65536);
  Fuzzed result;
  if (!type.serialize(&sample, &good)) return result;
  for (int i = 0; i < count; ++i) {
    eprosima::fastrtps::rtps::SerializedPayload_t bad(65536);
    bad.copy(&good);
    for (std::uint64_t change = random() % 4; change-- > 0;) {
      const std::size_t at = 4 + random() % (bad.length - 4);
      switch (random() % 4) {
        case 0:
          bad.data[at] = static_cast<unsigned char>(random());
          break;
        case 1:
          bad.data[at] = static_cast<unsigned char>(bad.data[at] ^ (1u << random() % 8));
          break;
        case 2:  // a word of ones: lengths
          for (std::size_t k = at & ~std::size_t{3}; k < (at | 3) + 1 && k < bad.length; ++k) {
            bad.data[k] = 0xff;
          }
          break;
        default:
          bad.length = static_cast<std::uint32_t>(at);
      }
      if (bad.length <= 4) break;
    }
    Sample read;
    if (!type.deserialize(&bad, &read)) {
      ++result.unreadable;
    } else if (door(read)) {
      ++result.passed;
    } else {
      ++result.refused;
    }
  }
  result.counted = counter->load();
  return result;
}

}  // namespace mortise::test
