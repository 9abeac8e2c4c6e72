#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <set>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "idl/dds_channel.h"
#include "idl/participant.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// Hears who comes and goes, in threads of Fast DDS; take() asks what it heard. Also the listener
/// of the presence reader.
class Doorman final : public dds::DomainParticipantListener {
 public:
  using Time = std::chrono::steady_clock::time_point;
  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = rtps::ParticipantDiscoveryInfo;
    const ClientKey client = client_key(info.info.m_guid);
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
      add(info.info.m_guid);
      if (!identities_) return;
      identities_->parted(client);
      const std::lock_guard lock(mutex_);
      unproven_since_.erase(client);
    } else if (identities_) {
      {
        const std::lock_guard lock(mutex_);
        unproven_since_.emplace(client, Time::clock::now());
      }
      const std::string* subject =
          rtps::DataHolderHelper::find_property_value(info.info.identity_token_, "dds.cert.sn");
      if (subject != nullptr) identities_->met(client, *subject);
    }
  }
  void onParticipantAuthentication(dds::DomainParticipant*,
                                   rtps::ParticipantAuthenticationInfo&& info) override {
    const std::lock_guard lock(mutex_);
    unproven_since_[client_key(info.guid)] = Time::max();  // answered, either way
    if (info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT)
      turned_away_.push_back(client_key(info.guid));
  }
  /// MANUAL_BY_TOPIC: also when other clients live, unlike automatic liveliness (Fast DDS #4373).
  void on_liveliness_changed(dds::DataReader*,
                             const dds::LivelinessChangedStatus& status) override {
    if (status.alive_count_change < 0 || status.not_alive_count_change > 0) {
      add(rtps::iHandle2GUID(status.last_publication_handle));
    }
  }
  std::vector<ClientKey> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(gone_, {});
  }
  /// Also those of whom nothing was proven in time: where the other end is to begin the handshake
  /// and does not like our certificate, nobody tells us.
  std::vector<ClientKey> take_turned_away() {
    constexpr auto kTimeToProve = std::chrono::seconds(2);
    const std::lock_guard lock(mutex_);
    for (auto& [client, since] : unproven_since_) {
      if (since == Time::max() || Time::clock::now() - since < kTimeToProve) continue;
      since = Time::max();  // said once
      turned_away_.push_back(client);
    }
    return std::exchange(turned_away_, {});
  }
  void know(PeerIdentities* identities) { identities_ = identities; }

 private:
  void add(const rtps::GUID_t& guid) {
    const std::lock_guard lock(mutex_);
    gone_.push_back(client_key(guid));
  }

  std::mutex mutex_;
  std::vector<ClientKey> gone_, turned_away_;
  std::map<ClientKey, Time> unproven_since_;  ///< max: proven, or said
  PeerIdentities* identities_ = nullptr;      ///< null: nobody proves anything
};

class DdsServerChannel final : public ServerChannel {
 public:
  Status open(const DdsOptions& options) {
    if (!options.keys.empty()) {
      const KeyFiles files(options.keys);
      identities_ = std::make_unique<PeerIdentities>(files.authority, files.revocations);
      doorman_.know(identities_.get());
    }
    auto participant = Participant::open(options, Participant::Side::kServer, &doorman_);
    if (!participant) return participant.error();
    participant_ = std::move(participant.value());
    Status status = ok();
    // The writers first: who is heard can be answered.
    participant_->open_writer<wire::AnswersPubSubType>(Topic::kAnswers, answers_, status);
    participant_->open_writer<wire::PoseBatchPubSubType>(Topic::kPose, poses_, status);
    participant_->open_writer<wire::PoseBatchPubSubType>(Topic::kKeyframe, keyframes_, status);
    participant_->open_writer<wire::EventBatchPubSubType>(Topic::kEvent, events_, status);
    participant_->open_writer<wire::SnapshotPubSubType>(Topic::kSnapshot, snapshots_, status);
    participant_->open_writer<wire::MeshChunkPubSubType>(Topic::kMesh, meshes_, status);
    participant_->open_writer<wire::FeaturesPubSubType>(Topic::kFeatures, features_, status);
    participant_->open_writer<wire::PulsePubSubType>(Topic::kPulse, pulses_, status);
    participant_->open_reader<wire::PresencePubSubType>(Topic::kPresence, &doorman_, presence_,
                                                        status);
    participant_->open_reader<wire::RequestPubSubType>(Topic::kRequest, nullptr, requests_, status);
    participant_->open_reader<wire::IncrementBatchPubSubType>(Topic::kIncrement, nullptr,
                                                              increments_, status);
    return status;
  }

  ServerInput take() override {
    ServerInput input;
    take_requests(input);
    take_presence(input);
    take_increments(input);
    take_departures(input);
    if (identities_) turn_away(input);
    return input;
  }

  void publish_join_reply(const JoinReply& reply) override {
    if (reply.refusal == Refusal::kNone && reply.user) joined_[reply.user] = reply.client;
    write(answers_, to_wire(std::span(&reply, 1), {}, {}));
  }
  void publish_replies(std::span<const Reply> replies) override {
    in_slices(replies, [this](auto slice) { write(answers_, to_wire({}, slice, {})); });
  }
  void publish_decisions(std::span<const Decision> decisions) override {
    in_slices<kDecisionSlice>(decisions,
                              [this](auto slice) { write(answers_, to_wire({}, {}, {}, slice)); });
  }
  void publish_refusals(std::span<const RefusedIncrement> refused) override {
    in_slices(refused, [this](auto slice) { write(answers_, to_wire({}, {}, slice)); });
  }
  void publish_poses(const PoseBatch& batch) override {
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
  void publish_events(std::span<const ClashEvent> events) override {
    if (events.empty()) return;
    for (const wire::EventBatch& chunk : cut(events)) write(events_, chunk);
  }
  void publish_snapshot(const Snapshot& snapshot) override {
    for (const wire::Snapshot& chunk : cut(snapshot, ++snapshot_serial_)) {
      write(snapshots_, chunk);
    }
  }
  void publish_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    const std::vector<wire::MeshChunk> chunks = cut_mesh(hash, bytes);
    mesh_chunks_ += chunks.size();
    if (mesh_chunks_ > static_cast<std::size_t>(row_of(Topic::kMesh).max_keys)) {
      mesh_chunks_ -= chunks.size();
      ++counters_.send_failed;  // no room for the whole mesh: none of it
      return;
    }
    for (const wire::MeshChunk& chunk : chunks) write(meshes_, chunk);
  }
  void publish_features(const FeatureTable& table) override {
    for (const wire::Features& chunk : cut(table, ++feature_serial_)) write(features_, chunk);
  }
  void publish_pulse(const SessionPulse& pulse) override {
    write(pulses_, to_wire(pulse, pose_serial_));
  }

  /// Also a client that is still joining counts, so that nothing said meanwhile is lost.
  bool has_readers() const override { return matched(poses_) || matched(events_); }
  ChannelCounters counters() const override {
    ChannelCounters counters = counters_;
    counters.malformed += participant_->refused();
    counters.guard_dropped = participant_->dropped();
    return counters;
  }

 private:
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++counters_.send_failed;
  }

  /// Texts are clipped to about 1 kB, so a slice stays below a datagram.
  template <std::size_t kSlice = 40, class Entry, class Action>
  static void in_slices(std::span<const Entry> entries, Action action) {
    for (std::size_t at = 0; at < entries.size(); at += kSlice) {
      action(entries.subspan(at, std::min(kSlice, entries.size() - at)));
    }
  }

  /// Hands each valid sample and its sender to the action.
  template <class Sample, class Action>
  void take_all(dds::DataReader* reader, Action action) {
    Sample sample;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      ++counters_.received;
      if (revoked_.contains(client_key(info.sample_identity.writer_guid()))) {
        ++counters_.foreign;
        continue;
      }
      action(sample, client_key(info.sample_identity.writer_guid()));
    }
  }

  /// Names, texts and a group's parts make at most 3 kB of a decision.
  static constexpr std::size_t kDecisionSlice = 15;

  bool owns(const ClientKey& client, UserId user) {
    const auto found = joined_.find(user);
    if (found != joined_.end() && found->second == client) return true;
    ++counters_.foreign;
    return false;
  }

  /// Last: who asked to join and is gone already does not get in, or would stay for ever. (One that
  /// lives after all asks again.)
  void take_departures(ServerInput& input) {
    for (const ClientKey& key : doorman_.take()) {
      // Only who has joined, and once: liveliness ends first, the participant's lease later.
      if (present_.erase(key) == 0) continue;
      std::erase_if(input.joins, [&](const JoinRequest& join) { return join.client == key; });
      input.lost.push_back({UserId{}, key, false});
    }
  }

  /// Fast DDS reads revocations once, when it begins: who was let in before stays. Here they go.
  void turn_away(ServerInput& input) {
    for (const ClientKey& key : identities_->newly_revoked()) {
      revoked_.insert(key);
      present_.erase(key);
      input.lost.push_back({UserId{}, key, false});
      input.turned_away.push_back(whose(key) +
                                  " has been revoked: what comes from there is dropped");
    }
    for (const ClientKey& key : doorman_.take_turned_away()) {
      input.turned_away.push_back(
          whose(key) + " was not let in: without keys, of another site, expired or revoked");
    }
    counters_.turned_away += input.turned_away.size();
  }
  std::string whose(const ClientKey& key) const {
    const std::optional<Identity> identity = identities_->identity_of(key);
    return identity ? "the certificate of '" + identity->name + "' (" + identity->role + ")"
                    : "a participant without a name (" + key + ")";
  }

  void take_requests(ServerInput& input) {
    take_all<wire::Request>(requests_, [&](const wire::Request& sample, const ClientKey& key) {
      Result<Request> request = from_wire(sample);
      if (!request) {
        ++counters_.malformed;
        if (sample.kind() == static_cast<std::uint8_t>(Request::Kind::kJoin)) {
          publish_join_reply(
              {key, sample.nonce(), UserId{}, Refusal::kNotAllowed, request.error().text});
        }
        return;
      }
      switch (request->kind) {
        case Request::Kind::kJoin:
          present_.insert(key);
          input.joins.push_back({key, request->nonce, request->name, request->role,
                                 identities_ ? identities_->identity_of(key) : std::nullopt});
          break;
        case Request::Kind::kLeave:
          if (owns(key, request->command.user)) {
            input.lost.push_back({request->command.user, key, true});
          }
          break;
        case Request::Kind::kCommand:
          input.commands.push_back({key, request->command});
          break;
        case Request::Kind::kSnapshot:
          input.snapshot_requests.push_back(key);
          break;
        case Request::Kind::kUnknown:
          break;
      }
    });
  }

  void take_presence(ServerInput& input) {
    take_all<wire::Presence>(presence_, [&](const wire::Presence& sample, const ClientKey& key) {
      const UserId user{sample.user()};
      if (user && owns(key, user)) input.heartbeats.push_back(user);
    });
  }

  void take_increments(ServerInput& input) {
    take_all<wire::IncrementBatch>(
        increments_, [&](const wire::IncrementBatch& sample, const ClientKey& key) {
          Result<std::vector<ReceivedIncrement>> read = from_wire(sample);
          if (!read) {
            ++counters_.malformed;
            return;
          }
          for (ReceivedIncrement& received : read.value()) {
            counters_.malformed += received.at_door != Refusal::kNone && !received.repeated;
            received.client = key;
            input.increments.push_back(std::move(received));
          }
        });
  }

  std::unique_ptr<PeerIdentities> identities_;  ///< null: no security
  Doorman doorman_;                             // before the participant, whose threads call it
  std::unique_ptr<Participant> participant_;
  dds::DataWriter *answers_ = nullptr, *poses_ = nullptr, *keyframes_ = nullptr, *events_ = nullptr,
                  *snapshots_ = nullptr, *meshes_ = nullptr, *features_ = nullptr,
                  *pulses_ = nullptr;
  dds::DataReader *presence_ = nullptr, *requests_ = nullptr, *increments_ = nullptr;
  std::uint64_t pose_serial_ = 0, keyframe_serial_ = 0, snapshot_serial_ = 0, feature_serial_ = 0;
  std::size_t mesh_chunks_ = 0;
  std::map<UserId, ClientKey> joined_;
  std::set<ClientKey> present_, revoked_;
  ChannelCounters counters_;
};

}  // namespace

Result<std::unique_ptr<ServerChannel>> open_server_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsServerChannel>();
  if (Status opened = channel->open(options); !opened) return opened.error();
  return std::unique_ptr<ServerChannel>(std::move(channel));
}

}  // namespace mortise
