#include "idl/client_readers.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "idl/convert.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

template <class Entry>
void append(std::vector<Entry>& from, std::vector<Entry>& to) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void ClientReaders::open(Participant& participant, const DdsOptions& options, Status& status) {
  participant_ = &participant;
  participant.open_reader<wire::PoseBatchPubSubType>(Topic::kPose, &poses_, poses_.reader, status);
  participant.open_reader<wire::PoseBatchPubSubType>(Topic::kKeyframe, &keyframes_,
                                                     keyframes_.reader, status);
  participant.open_reader<wire::EventBatchPubSubType>(Topic::kEvent, &events_, events_.reader,
                                                      status);
  participant.open_reader<wire::SnapshotPubSubType>(Topic::kSnapshot, &snapshots_,
                                                    snapshots_.reader, status);
  participant.open_reader<wire::PulsePubSubType>(Topic::kPulse, &pulses_, pulses_.reader, status);
  if (options.meshes)
    participant.open_reader<wire::MeshChunkPubSubType>(Topic::kMesh, &meshes_, meshes_.reader,
                                                       status);
  if (options.features)
    participant.open_reader<wire::FeaturesPubSubType>(Topic::kFeatures, &features_,
                                                      features_.reader, status);
}

void ClientReaders::open_answers(Participant& participant, Status& status) {
  participant.open_reader<wire::AnswersPubSubType>(Topic::kAnswers, &watch_, answers_, status);
}

void ClientReaders::take(const ClientKey& own, ClientInput& input) {
  take_answers(own, input);
  take_snapshots(input);
  take_poses(input);
  take_keyframes(input);
  take_events(input);
  take_pulses(input);
  take_meshes(input);
  take_features(input);
}

ChannelCounters ClientReaders::counters() const {
  ChannelCounters counters = counters_;
  counters.malformed += mesh_collector_.refused();
  return counters;
}

template <class Sample, class Action>
bool ClientReaders::take_each(dds::DataReader& reader, Action action) {
  return take_all<Sample>(
      reader, [&](const Sample& sample, const eprosima::fastrtps::rtps::GUID_t& writer) {
        ++counters_.received;
        if (watch_.is_past(writer.guidPrefix)) {
          ++counters_.foreign;
          return;
        }
        participant_->note_spoke(writer);
        if (writer.guidPrefix != server_) {
          server_ = writer.guidPrefix;
          begin_with_another_server();
        }
        action(sample);
      });
}

// Its numbers start anew.
void ClientReaders::begin_with_another_server() {
  snapshot_collector_.reset();
  keyframe_collector_.reset();
  mesh_collector_.reset();
  feature_collector_.reset();
  pose_serial_ = 0;
}

void ClientReaders::take_answers(const ClientKey& own, ClientInput& input) {
  take_each<wire::Answers>(*answers_, [&](const wire::Answers& sample) {
    Result<Answers> answers = from_wire(sample);
    if (!answers) {
      ++counters_.malformed;
      return;
    }
    for (JoinReply& reply : answers->joins)
      if (reply.client == own) input.join_replies.push_back(std::move(reply));
    append(answers->replies, input.replies);
    append(answers->refused, input.refused);
    append(answers->decisions, input.decisions);
    append(answers->standing, input.standing);
    append(answers->uploads, input.uploads);
  });
}

// The value of all chunks of a set; nothing, and counted, when one of them is malformed.
template <class Value, class Chunk, class Add>
std::optional<Value> ClientReaders::joined(const std::vector<Chunk>& chunks, Add add) {
  std::optional<Value> whole;
  for (const Chunk& chunk : chunks) {
    Result<Value> part = from_wire(chunk);
    if (!part) {
      ++counters_.malformed;
      return std::nullopt;
    }
    whole ? add(part.value(), *whole) : void(whole = std::move(part.value()));
  }
  return whole;
}

void ClientReaders::take_snapshots(ClientInput& input) {
  take_each<wire::Snapshot>(snapshots_, [&](const wire::Snapshot& sample) {
    const auto chunks = snapshot_collector_.add(sample);
    if (!chunks) return;
    auto whole = joined<Snapshot>(*chunks, [](Snapshot& part, Snapshot& into) {
      append(part.parts, into.parts);
      append(part.users, into.users);
      append(part.open_clashes, into.open_clashes);
      append(part.standing, into.standing);
      append(part.notes, into.notes);
      append(part.remarks, into.remarks);
    });
    if (whole) input.snapshots.push_back(std::move(*whole));
  });
}

void ClientReaders::take_poses(ClientInput& input) {
  take_each<wire::PoseBatch>(poses_, [&](const wire::PoseBatch& sample) {
    note_pose_serial(sample.serial(), input);
    Result<PoseBatch> batch = from_wire(sample);
    if (batch) {
      input.poses.push_back(std::move(batch.value()));
    } else {
      ++counters_.malformed;
    }
  });
}

void ClientReaders::take_keyframes(ClientInput& input) {
  take_each<wire::PoseBatch>(keyframes_, [&](const wire::PoseBatch& sample) {
    const auto chunks = keyframe_collector_.add(sample);
    if (!chunks) return;
    auto whole = joined<PoseBatch>(*chunks, [](PoseBatch& part, PoseBatch& into) {
      append(part.parts, into.parts);
      append(part.acks, into.acks);
    });
    if (!whole) return;
    whole->keyframe = true;
    input.poses.push_back(std::move(*whole));
  });
}

void ClientReaders::note_pose_serial(std::uint64_t serial, ClientInput& input) {
  if (pose_serial_ != 0 && serial > pose_serial_ + 1) {
    input.poses_missed += serial - pose_serial_ - 1;
    counters_.lost += serial - pose_serial_ - 1;
  }
  pose_serial_ = std::max(pose_serial_, serial);
}

void ClientReaders::take_events(ClientInput& input) {
  take_each<wire::EventBatch>(events_, [&](const wire::EventBatch& sample) {
    // What is malformed is missing in seq, which asks for a snapshot.
    std::vector<ClashEvent> events = events_from_wire(sample, counters_.malformed);
    append(events, input.events);
  });
}

void ClientReaders::take_pulses(ClientInput& input) {
  take_each<wire::Pulse>(pulses_, [&](const wire::Pulse& sample) {
    Result<SessionPulse> pulse = from_wire(sample);
    if (!pulse) {
      ++counters_.malformed;
      return;
    }
    // Shows the loss of a last batch before a silence. One serial of allowance: the last may still
    // be on its way.
    if (pose_serial_ != 0 && sample.pose_serial() > pose_serial_ + 1)
      note_pose_serial(sample.pose_serial(), input);
    input.pulses.push_back(*pulse);
  });
}

void ClientReaders::take_meshes(ClientInput& input) {
  take_each<wire::MeshChunk>(meshes_, [&](const wire::MeshChunk& sample) {
    if (auto mesh = mesh_collector_.add(sample)) input.meshes.push_back(std::move(*mesh));
  });
}

void ClientReaders::take_features(ClientInput& input) {
  take_each<wire::Features>(features_, [&](const wire::Features& sample) {
    const auto chunks = feature_collector_.add(sample);
    if (!chunks) return;
    auto whole = joined<FeatureTable>(
        *chunks, [](FeatureTable& part, FeatureTable& into) { append(part.sets, into.sets); });
    if (whole) input.features.push_back(std::move(*whole));
  });
}

}  // namespace mortise
