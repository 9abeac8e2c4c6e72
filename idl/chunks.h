#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "mortise.h"  // generated from mortise.idl

/// Samples larger than kSampleLimit_bytes are cut into chunks, each a sample of its own, and put
/// together again here.
namespace mortise {

std::vector<wire::Snapshot> cut(const Snapshot& snapshot, std::uint64_t serial);
/// With keyframe each chunk has the same serial; without, each is complete in itself and has its
/// own, from `serial` up.
std::vector<wire::PoseBatch> cut(const PoseBatch& batch, std::uint64_t serial);
std::vector<wire::EventBatch> cut(std::span<const ClashEvent> events);
/// What has no room in as many chunks as the topic has is left out and counted in each.
std::vector<wire::Features> cut(const FeatureTable& table, std::uint64_t serial);
std::vector<wire::ServerTick> cut(const ToldTick& told, std::uint64_t term);
std::vector<wire::MeshChunk> cut_mesh(const std::string& hash, std::span<const std::byte> bytes);

/// Collects the chunks of one serial; a newer serial takes the place of an older one.
template <class Chunk>
class ChunkCollector {
 public:
  /// All chunks in order when this one was the last to be missing.
  std::optional<std::vector<Chunk>> add(Chunk chunk) {
    if (chunk.serial() < serial_ || chunk.count() == 0 || chunk.chunk() >= chunk.count() ||
        chunk.count() > kMaxChunks) {
      return std::nullopt;
    }
    if (chunk.serial() > serial_ || count_ != chunk.count()) {
      chunks_.clear();
      serial_ = chunk.serial();
      count_ = chunk.count();
    }
    const std::uint32_t index = chunk.chunk();
    const bool was_new = chunks_.insert_or_assign(index, std::move(chunk)).second;
    if (!was_new || chunks_.size() < count_) return std::nullopt;
    std::vector<Chunk> whole;
    for (auto& [at, part] : chunks_) whole.push_back(std::move(part));
    chunks_.clear();
    ++serial_;  // what comes of this serial again is a repeat
    return whole;
  }
  void reset() { *this = {}; }

 private:
  static constexpr std::uint32_t kMaxChunks = 4096;  // above the keys of every topic of this kind
  std::uint64_t serial_ = 0;
  std::uint32_t count_ = 0;
  std::map<std::uint32_t, Chunk> chunks_;
};

/// Collects what one that leads tells of its ticks, each in pieces that come in order. A piece that
/// does not go on from the one before is dropped with what was there of its tick, and counted.
class TickCollector {
 public:
  /// The tick when this piece was the last of it.
  std::optional<ToldTick> add(const wire::ServerTick& piece);
  std::uint64_t dropped() const { return dropped_; }  ///< pieces

 private:
  static constexpr std::uint32_t kMaxPieces = 1024;  // 60 MB; a full tick of 64 users has one
  std::uint64_t term_ = 0, dropped_ = 0;
  std::uint32_t next_ = 0, count_ = 0;  ///< next 0: no tick is begun
  ToldTick tick_;
};

/// Collects meshes. A mesh whose bytes do not match its key is refused and counted.
class MeshCollector {
 public:
  std::optional<MeshBytes> add(const wire::MeshChunk& chunk);
  std::uint64_t refused() const { return refused_; }
  void reset() { partial_.clear(); }  ///< meshes that are whole are not given twice

 private:
  struct Partial {
    std::string name;
    std::map<std::uint32_t, std::vector<std::uint8_t>> chunks;
    std::uint32_t count = 0;
  };
  std::map<std::uint64_t, Partial> partial_;
  std::set<std::uint64_t> done_;
  std::uint64_t refused_ = 0;
};

}  // namespace mortise
