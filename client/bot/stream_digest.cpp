#include "client/bot/stream_digest.h"

#include "common/base/hash.h"

namespace mortise {
namespace {

std::uint64_t chained(std::uint64_t before, const ClashEvent& event) {
  StateHash hash;
  hash.add(before);
  hash.add(event.seq);
  hash.add(std::uint64_t{event.clash.value});
  hash.add(static_cast<std::uint64_t>(event.kind));
  hash.add(static_cast<std::uint64_t>(event.verdict.collision_class));
  return hash.value();
}

}  // namespace

void StreamDigest::add(const ClashEvent& event) {
  hash_ = chained(hash_, event);
  const std::uint64_t place = (event.seq - 1) % kBlock;
  if (place == 0 || event.seq != last_seq_ + 1) block_hash_ = in_block_ = 0;
  last_seq_ = event.seq;
  block_hash_ = chained(block_hash_, event);
  ++in_block_;
  if (place == kBlock - 1 && in_block_ == kBlock) blocks_[(event.seq - 1) / kBlock] = block_hash_;
}

StreamComparison compare_streams(
    std::span<const std::map<std::uint64_t, std::uint64_t>> participants) {
  struct Seen {
    std::uint64_t hash = 0, times = 0;
    bool differs = false;
  };
  std::map<std::uint64_t, Seen> seen;
  for (const auto& blocks : participants) {
    for (const auto& [block, hash] : blocks) {
      Seen& s = seen[block];
      if (s.times++ == 0) s.hash = hash;
      s.differs = s.differs || s.hash != hash;
    }
  }
  StreamComparison comparison;
  for (const auto& [block, s] : seen) {
    if (s.times < 2) continue;
    ++comparison.blocks;
    comparison.differing += s.differs ? 1 : 0;
  }
  return comparison;
}

}  // namespace mortise
