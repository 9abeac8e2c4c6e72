#include "idl/chunks.h"

#include <algorithm>
#include <utility>

#include "common/base/hash.h"
#include "idl/convert.h"
#include "idl/topics.h"

namespace mortise {
namespace {

// Of a sample: encapsulation, and up to 7 bytes of alignment for each of a few members.
constexpr std::size_t kSampleOverhead_bytes = 64;
// An entry's size depends on where it starts: at most this much more than counted from 0.
constexpr std::size_t kAlignment_bytes = 8;

// So many of a set in one entry stay below a sample: 16 kB of parts, 35 kB of features.
constexpr std::size_t kSetParts = 4096, kSetFeatures = 128;

template <class Entry>
std::size_t size_of(const Entry& entry) {
  return Entry::getCdrSerializedSize(entry) + kAlignment_bytes;
}

/// Adds entries to chunks, opening a new one when the last is full.
template <class Chunk>
class Cutter {
 public:
  explicit Cutter(const Chunk& empty) : empty_(empty), room_(room_of(empty)), chunks_{empty} {}

  template <class Entry, class Member>
  void add(Entry entry, Member member) {
    const std::size_t size = size_of(entry);
    if (size > left_ && used_) open();
    left_ -= std::min(left_, size);
    used_ = true;
    (chunks_.back().*member)().push_back(std::move(entry));
  }
  std::vector<Chunk> take() && { return std::move(chunks_); }

 private:
  static std::size_t room_of(const Chunk& empty) {
    return kSampleLimit_bytes - kSampleOverhead_bytes - Chunk::getCdrSerializedSize(empty);
  }
  void open() {
    chunks_.push_back(empty_);
    left_ = room_;
    used_ = false;
  }

  Chunk empty_;
  std::size_t room_ = 0, left_ = room_;
  bool used_ = false;
  std::vector<Chunk> chunks_;
};

template <class Chunk>
void number(std::vector<Chunk>& chunks) {
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    chunks[i].chunk(static_cast<std::uint32_t>(i));
    chunks[i].count(static_cast<std::uint32_t>(chunks.size()));
  }
}

std::uint64_t key_of(std::span<const std::byte> bytes) {
  StateHash hash;
  hash.add(bytes);
  return hash.value();
}

template <class Entry, class Chunk>
auto member(std::vector<Entry>& (Chunk::*accessor)()) {
  return accessor;
}

}  // namespace

std::vector<wire::Snapshot> cut(const Snapshot& snapshot, std::uint64_t serial) {
  wire::Snapshot head;
  head.serial(serial);
  head.tick(snapshot.tick);
  head.event_seq(snapshot.event_seq);
  head.tick_rate_hz(snapshot.tick_rate_hz);
  head.session(clip(snapshot.session, kMaxName_bytes));
  head.policy(clip(snapshot.policy, kMaxName_bytes));
  Cutter<wire::Snapshot> cutter(head);
  for (const PartInfo& part : snapshot.parts) {
    cutter.add(to_wire(part), member<wire::PartInfo>(&wire::Snapshot::parts));
  }
  for (const UserInfo& user : snapshot.users) {
    cutter.add(to_wire(user), member<wire::UserInfo>(&wire::Snapshot::users));
  }
  for (const ClashEvent& event : snapshot.open_clashes) {
    cutter.add(to_wire(event), member<wire::ClashEvent>(&wire::Snapshot::open_clashes));
  }
  for (const Decision& decision : snapshot.standing) {
    cutter.add(to_wire(decision), member<wire::Decision>(&wire::Snapshot::standing));
  }
  for (const PartNote& note : snapshot.notes) {
    cutter.add(to_wire(note), member<wire::PartNote>(&wire::Snapshot::notes));
  }
  for (const Remark& remark : snapshot.remarks) {
    cutter.add(to_wire(remark), member<wire::Remark>(&wire::Snapshot::remarks));
  }
  std::vector<wire::Snapshot> chunks = std::move(cutter).take();
  number(chunks);
  return chunks;
}

std::vector<wire::PoseBatch> cut(const PoseBatch& batch, std::uint64_t serial) {
  wire::PoseBatch head;
  head.serial(serial);
  head.tick(batch.tick);
  head.event_seq(batch.event_seq);
  head.sent_ns(batch.sent_ns);
  Cutter<wire::PoseBatch> cutter(head);
  for (const Ack& ack : batch.acks) {
    cutter.add(to_wire(ack), member<wire::Ack>(&wire::PoseBatch::acks));
  }
  for (const PartPose& pose : batch.parts) {
    cutter.add(to_wire(pose), member<wire::PartPose>(&wire::PoseBatch::parts));
  }
  std::vector<wire::PoseBatch> chunks = std::move(cutter).take();
  number(chunks);
  if (!batch.keyframe) {
    for (wire::PoseBatch& chunk : chunks) chunk.serial(serial++);
  }
  return chunks;
}

std::vector<wire::EventBatch> cut(std::span<const ClashEvent> events) {
  Cutter<wire::EventBatch> cutter{wire::EventBatch()};
  for (const ClashEvent& event : events) {
    cutter.add(to_wire(event), member<wire::ClashEvent>(&wire::EventBatch::events));
  }
  return std::move(cutter).take();
}

std::vector<wire::Features> cut(const FeatureTable& table, std::uint64_t serial) {
  wire::Features head;
  head.serial(serial);
  head.meshes_waiting(table.meshes_waiting);
  head.meshes_too_large(table.meshes_too_large);
  Cutter<wire::Features> cutter(head);
  std::uint32_t left_out = table.left_out;
  for (const FeatureSet& set : table.sets) {
    std::vector<wire::Feature> features;
    for (const FeatureInfo& feature : set.features) {
      features.push_back(to_wire(feature));
      // One that the door of the others would refuse must not cost them the whole table.
      if (from_wire(features.back())) continue;
      features.pop_back();
      ++left_out;
    }
    for (std::size_t p = 0; p < set.parts.size(); p += kSetParts) {
      for (std::size_t f = 0; f < features.size(); f += kSetFeatures) {
        wire::FeatureSet entry;
        for (std::size_t i = p; i < std::min(set.parts.size(), p + kSetParts); ++i)
          entry.parts().push_back(set.parts[i].value);
        const auto first = features.begin() + static_cast<std::ptrdiff_t>(f);
        entry.features().assign(first, first + static_cast<std::ptrdiff_t>(
                                                   std::min(kSetFeatures, features.size() - f)));
        cutter.add(std::move(entry), member<wire::FeatureSet>(&wire::Features::sets));
      }
    }
  }
  std::vector<wire::Features> chunks = std::move(cutter).take();
  while (chunks.size() > static_cast<std::size_t>(row_of(Topic::kFeatures).max_keys)) {
    for (const wire::FeatureSet& set : chunks.back().sets())
      left_out += static_cast<std::uint32_t>(set.features().size());
    chunks.pop_back();
  }
  for (wire::Features& chunk : chunks) chunk.left_out(left_out);
  number(chunks);
  return chunks;
}

std::vector<wire::ServerTick> cut(const ToldTick& told, std::uint64_t term) {
  const std::span<const std::byte> bytes(told.bytes);
  const std::size_t step = kSampleLimit_bytes - kSampleOverhead_bytes;
  const std::size_t count = std::max<std::size_t>(1, (bytes.size() + step - 1) / step);
  std::vector<wire::ServerTick> chunks(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto part = bytes.subspan(i * step, std::min(step, bytes.size() - i * step));
    const auto* first = reinterpret_cast<const std::uint8_t*>(part.data());
    chunks[i].tick(told.tick);
    chunks[i].term(term);
    chunks[i].bytes().assign(first, first + part.size());
  }
  number(chunks);
  return chunks;
}

std::vector<wire::MeshChunk> cut_mesh(const std::string& hash, std::span<const std::byte> bytes) {
  const std::uint64_t key = key_of(bytes);
  const std::size_t step = kSampleLimit_bytes - kSampleOverhead_bytes - kMaxName_bytes;
  const std::size_t count = std::max<std::size_t>(1, (bytes.size() + step - 1) / step);
  std::vector<wire::MeshChunk> chunks(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto part = bytes.subspan(i * step, std::min(step, bytes.size() - i * step));
    const auto* first = reinterpret_cast<const std::uint8_t*>(part.data());
    chunks[i].mesh(key);
    chunks[i].mesh_hash(clip(hash, kMaxName_bytes));
    chunks[i].bytes().assign(first, first + part.size());
  }
  number(chunks);
  return chunks;
}

std::optional<ToldTick> TickCollector::add(const wire::ServerTick& piece) {
  const bool possible = piece.chunk() < piece.count() && piece.count() <= kMaxPieces &&
                        piece.bytes().size() <= kSampleLimit_bytes;
  const bool follows = piece.chunk() == next_ && piece.tick() == tick_.tick &&
                       piece.term() == term_ && piece.count() == count_;
  if (!possible || (piece.chunk() > 0 && !follows)) {
    dropped_ += 1 + std::exchange(next_, 0);
    tick_ = {};
    return std::nullopt;
  }
  if (piece.chunk() == 0) {
    dropped_ += std::exchange(next_, 0);
    tick_ = {piece.tick(), {}};
    term_ = piece.term();
    count_ = piece.count();
  }
  const auto bytes = std::as_bytes(std::span(piece.bytes()));
  tick_.bytes.insert(tick_.bytes.end(), bytes.begin(), bytes.end());
  if (++next_ < count_) return std::nullopt;
  next_ = 0;
  return std::exchange(tick_, {});
}

std::optional<MeshBytes> MeshCollector::add(const wire::MeshChunk& chunk) {
  const auto max_chunks = static_cast<std::uint32_t>(row_of(Topic::kMesh).max_keys);
  if (chunk.count() == 0 || chunk.count() > max_chunks || chunk.chunk() >= chunk.count() ||
      !text_ok(chunk.mesh_hash(), kMaxName_bytes) || chunk.bytes().size() > kSampleLimit_bytes) {
    ++refused_;
    return std::nullopt;
  }
  if (done_.contains(chunk.mesh())) return std::nullopt;
  Partial& partial = partial_[chunk.mesh()];
  if (partial.count != chunk.count()) partial = {chunk.mesh_hash(), {}, chunk.count()};
  partial.chunks[chunk.chunk()] = chunk.bytes();
  if (partial.chunks.size() < partial.count) return std::nullopt;
  MeshBytes mesh{partial.name, {}};
  for (const auto& [index, bytes] : partial.chunks) {
    const auto part = std::as_bytes(std::span(bytes));
    mesh.bytes.insert(mesh.bytes.end(), part.begin(), part.end());
  }
  partial_.erase(chunk.mesh());
  if (key_of(mesh.bytes) != chunk.mesh()) {
    ++refused_;
    return std::nullopt;
  }
  done_.insert(chunk.mesh());
  return mesh;
}

}  // namespace mortise
