#include "idl/server_writers.h"

#include <algorithm>
#include <chrono>

#include "idl/chunks.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

// Texts are clipped to about 1 kB, so that so many stay below a datagram. Names, texts and a
// group's parts make at most 3 kB of a decision.
constexpr std::size_t kSlice = 40, kDecisionSlice = 15;

template <class Entry, class Action>
void in_slices(std::span<const Entry> entries, std::size_t size, Action action) {
  for (std::size_t at = 0; at < entries.size(); at += size)
    action(entries.subspan(at, std::min(size, entries.size() - at)));
}

}  // namespace

void ServerWriters::open(Participant& participant, Status& status) {
  participant.open_writer<wire::AnswersPubSubType>(Topic::kAnswers, answers_, status);
  participant.open_writer<wire::PoseBatchPubSubType>(Topic::kPose, poses_, status);
  participant.open_writer<wire::PoseBatchPubSubType>(Topic::kKeyframe, keyframes_, status);
  participant.open_writer<wire::EventBatchPubSubType>(Topic::kEvent, events_, status);
  participant.open_writer<wire::SnapshotPubSubType>(Topic::kSnapshot, snapshots_, status);
  participant.open_writer<wire::MeshChunkPubSubType>(Topic::kMesh, meshes_, status);
  participant.open_writer<wire::FeaturesPubSubType>(Topic::kFeatures, features_, status);
  participant.open_writer<wire::PulsePubSubType>(Topic::kPulse, pulses_, status);
}

void ServerWriters::change_term(Participant& participant, std::uint64_t term) {
  participant.change_term(*answers_, term);
}

void ServerWriters::close(double at_most_s) {
  snapshot_sayer_.stop();
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(at_most_s);
  for (dds::DataWriter* writer : {answers_, events_, snapshots_, pulses_}) {
    const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
    if (writer == nullptr || left.count() <= 0.0) continue;
    writer->wait_for_acknowledgments(
        eprosima::fastrtps::Duration_t(static_cast<long double>(left.count())));
  }
}

void ServerWriters::say(std::span<const Reply> replies) {
  in_slices(replies, kSlice, [this](auto slice) { say(to_wire({}, slice, {})); });
}

void ServerWriters::say(std::span<const RefusedIncrement> refused) {
  in_slices(refused, kSlice, [this](auto slice) { say(to_wire({}, {}, slice)); });
}

void ServerWriters::say(std::span<const Decision> decisions) {
  in_slices(decisions, kDecisionSlice, [this](auto slice) { say(to_wire({}, {}, {}, slice)); });
}

void ServerWriters::say(std::span<const StandingChange> changes) {
  in_slices(changes, kDecisionSlice, [this](auto slice) { say(to_wire({}, {}, {}, {}, slice)); });
}

void ServerWriters::say(std::span<const UploadState> uploads) {
  in_slices(uploads, kSlice, [this](auto slice) { say(to_wire({}, {}, {}, {}, {}, slice)); });
}

void ServerWriters::say(const PoseBatch& batch) {
  if (batch.keyframe) {
    for (const wire::PoseBatch& chunk : cut(batch, ++keyframe_serial_)) write(keyframes_, chunk);
    return;
  }
  if (!matched(poses_)) return;
  for (const wire::PoseBatch& chunk : cut(batch, pose_serial_ + 1)) {
    pose_serial_ = chunk.serial();
    write(poses_, chunk);
  }
}

void ServerWriters::say(std::span<const ClashEvent> events) {
  if (events.empty()) return;
  for (const wire::EventBatch& chunk : cut(events)) write(events_, chunk);
}

void ServerWriters::say_now(const Snapshot& snapshot) {
  for (const wire::Snapshot& chunk : cut(snapshot, ++snapshot_serial_)) write(snapshots_, chunk);
}

void ServerWriters::say(const std::string& mesh_hash, std::span<const std::byte> mesh) {
  const std::lock_guard lock(mesh_mutex_);
  if (!said_meshes_.insert(mesh_hash).second) return;
  const std::vector<wire::MeshChunk> chunks = cut_mesh(mesh_hash, mesh);
  if (mesh_chunks_ + chunks.size() > static_cast<std::size_t>(row_of(Topic::kMesh).max_keys)) {
    ++failed_;  // no room for the whole mesh: none of it
    return;
  }
  mesh_chunks_ += chunks.size();
  for (const wire::MeshChunk& chunk : chunks) write(meshes_, chunk);
}

void ServerWriters::say(const FeatureTable& table) {
  for (const wire::Features& chunk : cut(table, ++feature_serial_)) write(features_, chunk);
}

void ServerWriters::say(const SessionPulse& pulse) { write(pulses_, to_wire(pulse, pose_serial_)); }

}  // namespace mortise
