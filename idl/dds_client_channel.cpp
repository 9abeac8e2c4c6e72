#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "idl/dds_channel.h"
#include "idl/participant.h"
#include "idl/server_watch.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

using Clock = std::chrono::steady_clock;

class DdsClientChannel final : public ClientChannel {
 public:
  Status open(const DdsOptions& options) {
    watch_.look_for(options.session);
    if (!options.keys.empty()) {
      const KeyFiles files(options.keys);
      identities_ = std::make_unique<PeerIdentities>(files.authority, files.revocations);
      watch_.know(identities_.get());
    }
    auto participant = Participant::open(options, Participant::Side::kClient, &watch_);
    if (!participant) return participant.error();
    participant_ = std::move(participant.value());
    key_ = participant_->key();
    assert_period_ = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(0.25 * options.liveliness_lease_s));
    Status status = ok();
    participant_->open_reader<wire::PoseBatchPubSubType>(Topic::kPose, nullptr, poses_, status);
    participant_->open_reader<wire::PoseBatchPubSubType>(Topic::kKeyframe, nullptr, keyframes_,
                                                         status);
    participant_->open_reader<wire::EventBatchPubSubType>(Topic::kEvent, nullptr, events_, status);
    participant_->open_reader<wire::SnapshotPubSubType>(Topic::kSnapshot, nullptr, snapshots_,
                                                        status);
    participant_->open_reader<wire::PulsePubSubType>(Topic::kPulse, nullptr, pulses_, status);
    if (options.meshes) {
      participant_->open_reader<wire::MeshChunkPubSubType>(Topic::kMesh, nullptr, meshes_, status);
    }
    if (options.features) {
      participant_->open_reader<wire::FeaturesPubSubType>(Topic::kFeatures, nullptr, features_,
                                                          status);
    }
    participant_->open_writer<wire::PresencePubSubType>(Topic::kPresence, presence_, status,
                                                        &watch_);
    // An observer's permissions have no increments.
    if (!participant_->identity() || participant_->identity()->role != "observer") {
      participant_->open_writer<wire::IncrementBatchPubSubType>(Topic::kIncrement, increments_,
                                                                status, &watch_);
    }
    participant_->open_writer<wire::RequestPubSubType>(Topic::kRequest, requests_, status, &watch_);
    // Last: once the server's answers are matched, everything else is declared.
    participant_->open_reader<wire::AnswersPubSubType>(Topic::kAnswers, &watch_, answers_, status);
    return status;
  }

  void join(std::uint64_t nonce, const std::string& name, const std::string& role) override {
    assert_presence();
    Request request;
    request.kind = Request::Kind::kJoin;
    request.nonce = nonce;
    request.name = name;
    request.role = role;
    write(requests_, to_wire(request));
  }
  void leave(UserId user) override {
    Request request;
    request.kind = Request::Kind::kLeave;
    request.command.user = user;
    write(requests_, to_wire(request));
  }
  void heartbeat(UserId user) override {
    wire::Presence sample;
    sample.user(user.value);
    sample.beat(++beat_);
    write(presence_, sample);
    asserted_at_ = Clock::now();
  }
  void send(const IncrementBatch& batch) override {
    assert_presence();
    if (increments_ == nullptr) {
      ++counters_.send_failed;
      for (const auto& [increment, sent_ns] : batch.increments)
        unsent_.push_back({increment.user, increment.part, increment.seq, Refusal::kObserver});
      return;
    }
    write(increments_, to_wire(batch));
  }
  void send(const Command& command) override {
    assert_presence();
    Request request;
    request.kind = Request::Kind::kCommand;
    request.command = command;
    write(requests_, to_wire(request));
  }
  void request_snapshot() override {
    Request request;
    request.kind = Request::Kind::kSnapshot;
    write(requests_, to_wire(request));
  }

  ClientInput take() override {
    ClientInput input;
    input.server_lost = std::exchange(lost_, false);  // the input before had its last words
    take_answers(input);
    take_snapshots(input);
    take_poses(input);
    take_events(input);
    take_pulses(input);
    take_meshes(input);
    take_features(input);
    refuse_unsent(input);
    // Answers can be heard; and what is sent from now on will be.
    const ServerWatch::Answer watch = watch_.take(increments_ == nullptr ? 2 : 3);
    lost_ = watch.lost;
    input.server_present = watch.present && !lost_;
    return input;
  }

  ChannelCounters counters() const override {
    ChannelCounters counters = counters_;
    counters.malformed += participant_->refused() + mesh_collector_.refused();
    counters.guard_dropped = participant_->dropped();
    counters.trailers_cut = participant_->cut();
    return counters;
  }

 private:
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++counters_.send_failed;
  }

  /// Says that this process lives, a few times within the lease.
  void assert_presence() {
    const Clock::time_point now = Clock::now();
    if (now - asserted_at_ < assert_period_) return;
    asserted_at_ = now;
    presence_->assert_liveliness();
  }

  /// Hands each valid sample to the action; whoever wrote it is asked for by `writer`.
  template <class Sample, class Action>
  void take_all(dds::DataReader* reader, Action action) {
    if (reader == nullptr) return;
    Sample sample;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      ++counters_.received;
      const rtps::GuidPrefix_t& from = info.sample_identity.writer_guid().guidPrefix;
      if (watch_.is_past(from)) {
        ++counters_.foreign;
        continue;
      }
      if (from != server_) {
        // Another server than before: its numbers start anew.
        server_ = from;
        snapshot_collector_.reset();
        keyframe_collector_.reset();
        mesh_collector_.reset();
        feature_collector_.reset();
        pose_serial_ = 0;
      }
      action(sample);
    }
  }

  void take_answers(ClientInput& input) {
    take_all<wire::Answers>(answers_, [&](const wire::Answers& sample) {
      Result<Answers> answers = from_wire(sample);
      if (!answers) {
        ++counters_.malformed;
        return;
      }
      for (JoinReply& reply : answers->joins) {
        if (reply.client == key_) input.join_replies.push_back(std::move(reply));
      }
      append(answers->replies, input.replies);
      append(answers->refused, input.refused);
      append(answers->decisions, input.decisions);
      append(answers->standing, input.standing);
    });
  }

  /// The value of all chunks of a set; nothing, and counted, when one of them is malformed.
  template <class Value, class Chunk, class Add>
  std::optional<Value> joined(const std::vector<Chunk>& chunks, Add add) {
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

  void take_snapshots(ClientInput& input) {
    take_all<wire::Snapshot>(snapshots_, [&](const wire::Snapshot& sample) {
      const auto chunks = snapshot_collector_.add(sample);
      if (!chunks) return;
      auto whole = joined<Snapshot>(*chunks, [](Snapshot& part, Snapshot& into) {
        append(part.parts, into.parts);
        append(part.users, into.users);
        append(part.open_clashes, into.open_clashes);
        append(part.standing, into.standing);
      });
      if (whole) input.snapshots.push_back(std::move(*whole));
    });
  }

  void take_poses(ClientInput& input) {
    take_all<wire::PoseBatch>(poses_, [&](const wire::PoseBatch& sample) {
      note_pose_serial(sample.serial(), input);
      Result<PoseBatch> batch = from_wire(sample);
      if (batch) {
        input.poses.push_back(std::move(batch.value()));
      } else {
        ++counters_.malformed;
      }
    });
    take_all<wire::PoseBatch>(keyframes_, [&](const wire::PoseBatch& sample) {
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

  void note_pose_serial(std::uint64_t serial, ClientInput& input) {
    if (pose_serial_ != 0 && serial > pose_serial_ + 1) {
      input.poses_missed += serial - pose_serial_ - 1;
      counters_.lost += serial - pose_serial_ - 1;
    }
    pose_serial_ = std::max(pose_serial_, serial);
  }

  void take_events(ClientInput& input) {
    take_all<wire::EventBatch>(events_, [&](const wire::EventBatch& sample) {
      // What is malformed is missing in seq, which asks for a snapshot.
      std::vector<ClashEvent> events = events_from_wire(sample, counters_.malformed);
      append(events, input.events);
    });
  }

  void take_pulses(ClientInput& input) {
    take_all<wire::Pulse>(pulses_, [&](const wire::Pulse& sample) {
      Result<SessionPulse> pulse = from_wire(sample);
      if (!pulse) {
        ++counters_.malformed;
        return;
      }
      // Shows the loss of a last batch before a silence. One serial of allowance: the last may
      // still be on its way.
      if (pose_serial_ != 0 && sample.pose_serial() > pose_serial_ + 1) {
        note_pose_serial(sample.pose_serial(), input);
      }
      input.pulses.push_back(*pulse);
    });
  }

  void take_meshes(ClientInput& input) {
    take_all<wire::MeshChunk>(meshes_, [&](const wire::MeshChunk& sample) {
      if (auto mesh = mesh_collector_.add(sample)) input.meshes.push_back(std::move(*mesh));
    });
  }

  void take_features(ClientInput& input) {
    take_all<wire::Features>(features_, [&](const wire::Features& sample) {
      const auto chunks = feature_collector_.add(sample);
      if (!chunks) return;
      auto whole = joined<FeatureTable>(
          *chunks, [](FeatureTable& part, FeatureTable& into) { append(part.sets, into.sets); });
      if (whole) input.features.push_back(std::move(*whole));
    });
  }

  /// Of an observer with keys: as a server answers one without, lest it is sent again for ever.
  void refuse_unsent(ClientInput& input) {
    PoseBatch answered;
    for (const RefusedIncrement& refused : unsent_)
      answered.acks.push_back({refused.user, refused.seq, 0});
    if (!unsent_.empty()) input.poses.push_back(std::move(answered));
    append(unsent_, input.refused);
    unsent_.clear();
  }

  template <class Entry>
  static void append(std::vector<Entry>& from, std::vector<Entry>& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  }

  std::unique_ptr<PeerIdentities> identities_;  ///< null: no security
  ServerWatch watch_;                           // before the participant, whose threads call it
  std::unique_ptr<Participant> participant_;
  ClientKey key_;
  dds::DataReader *answers_ = nullptr, *poses_ = nullptr, *keyframes_ = nullptr, *events_ = nullptr,
                  *snapshots_ = nullptr, *pulses_ = nullptr, *meshes_ = nullptr,
                  *features_ = nullptr;
  dds::DataWriter *presence_ = nullptr, *increments_ = nullptr, *requests_ = nullptr;
  Clock::duration assert_period_{};
  Clock::time_point asserted_at_{};
  std::uint64_t beat_ = 0;
  std::vector<RefusedIncrement> unsent_;  ///< an observer's, to be told with the next input
  bool lost_ = false;                     ///< to be told with the next input
  rtps::GuidPrefix_t server_;
  ChunkCollector<wire::Snapshot> snapshot_collector_;
  ChunkCollector<wire::PoseBatch> keyframe_collector_;
  MeshCollector mesh_collector_;
  ChunkCollector<wire::Features> feature_collector_;
  std::uint64_t pose_serial_ = 0;
  ChannelCounters counters_;
};

}  // namespace

Result<std::unique_ptr<ClientChannel>> open_client_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsClientChannel>();
  if (Status opened = channel->open(options); !opened) return opened.error();
  return std::unique_ptr<ClientChannel>(std::move(channel));
}

}  // namespace mortise
