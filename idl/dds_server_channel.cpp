#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "idl/dds_channel.h"
#include "idl/doorman.h"
#include "idl/following.h"
#include "idl/participant.h"
#include "idl/server_places.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

constexpr int kLookForLeader_ms = 2000;
constexpr int kLastWords_ms = 300;

class DdsServerChannel final : public StandbyChannel {
 public:
  /// Says goodbye after its last words were heard; who does not listen is not waited for long.
  ~DdsServerChannel() override {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kLastWords_ms);
    for (dds::DataWriter* writer : {answers_, events_, snapshots_, pulses_}) {
      const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
      if (writer == nullptr || left.count() <= 0.0) continue;
      writer->wait_for_acknowledgments(
          eprosima::fastrtps::Duration_t(static_cast<long double>(left.count())));
    }
  }
  Status open(const DdsOptions& options) {
    if (Status met = meet(options, Participant::Side::kServer); !met) return met;
    if (may_have_another_server(options)) {
      if (Status listening = listen_to_servers(); !listening) return listening;
      // One that leads tells a tick as soon as it sees us.
      for (int waited_ms = 0; waited_ms < kLookForLeader_ms && leader_.leader().empty();
           ++waited_ms) {
        take_told(nullptr);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      if (!leader_.leader().empty())
        return fail(Code::kRuntime, "another server leads session '" + options.session +
                                        "'; start this one with --standby-of " + options.session);
    }
    return take_over();
  }
  Status stand_by(const DdsOptions& options) {
    if (Status met = meet(options, Participant::Side::kStandby); !met) return met;
    Status status = listen_to_servers();
    participant_->open_writer<wire::ServerTakenPubSubType>(Topic::kTaken, taken_, status);
    return status;
  }
  Status take_over() override {
    term_ = next_term(std::max(leader_.term(), led_until_ms_));
    participant_->set_term(term_);
    if (Status opened = open_endpoints(); !opened) return opened;
    beat_ = std::make_unique<Heartbeat>(*ticks_);
    return told_ != nullptr ? ok() : listen_to_servers();
  }
  void lead_anew() override {
    term_ = next_term(term_);
    participant_->change_term(*answers_, term_);
  }
  std::uint64_t term_ms() const override { return term_; }
  std::string barred() const override {
    const std::optional<Identity>& own = participant_->identity();
    if (!identities_ || !own || !identities_->is_revoked(*own)) return {};
    return "the certificate of '" + own->name +
           "' (server) has been revoked: this server ends; issue a new one with mortise keys";
  }
  void confirm(const TakenTicks& taken) override {
    wire::ServerTaken sample;
    sample.tick(taken.received);
    sample.term(leader_.term());
    sample.computed(taken.computed);
    write(taken_, sample);
  }
  std::vector<ToldTick> follow() override {
    ServerInput nobody;
    if (identities_) turn_away(nobody);  // the one that leads may be revoked, too
    std::vector<ToldTick> ticks;
    take_told(&ticks);
    return ticks;
  }
  bool leader_present() const override { return servers_.is_alive(leader_.leader()); }
  bool another_stands_by() const override {
    return !leader_.counts_on().empty() && leader_.counts_on() != participant_->key();
  }

 private:
  Status meet(const DdsOptions& options, Participant::Side side) {
    if (!options.keys.empty()) {
      const KeyFiles files(options.keys);
      identities_ = std::make_unique<PeerIdentities>(files.authority, files.revocations);
      doorman_.know(identities_.get());
    }
    auto participant = Participant::open(options, side, &doorman_);
    if (!participant) return participant.error();
    participant_ = std::move(participant.value());
    led_until_ms_ = options.led_until_ms;
    servers_.know_own(participant_->key());
    return ok();
  }
  Status listen_to_servers() {
    Status status = ok();
    participant_->open_reader<wire::ServerTickPubSubType>(Topic::kTick, &servers_, told_, status);
    return status;
  }
  Status open_endpoints() {
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
    participant_->open_writer<wire::ServerTickPubSubType>(Topic::kTick, ticks_, status, &servers_);
    participant_->open_reader<wire::ServerTakenPubSubType>(Topic::kTaken, &takings_, follows_,
                                                           status);
    participant_->open_reader<wire::PresencePubSubType>(Topic::kPresence, &doorman_, presence_,
                                                        status);
    participant_->open_reader<wire::RequestPubSubType>(Topic::kRequest, nullptr, requests_, status);
    participant_->open_reader<wire::IncrementBatchPubSubType>(Topic::kIncrement, nullptr,
                                                              increments_, status);
    return status;
  }

 public:
  ServerInput take() override {
    ServerInput input;
    if (identities_) turn_away(input);  // first: who has to go does not come in by this take()
    input.follower_came = servers_.take_came();
    input.superseded = take_told(nullptr);
    take_requests(input);
    take_presence(input);
    take_increments(input);
    take_departures(input);
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
  void publish_standing(std::span<const StandingChange> changes) override {
    in_slices<kDecisionSlice>(
        changes, [this](auto slice) { write(answers_, to_wire({}, {}, {}, {}, slice)); });
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

  bool has_follower() const override { return servers_.has_follower(); }
  void publish_tick(const ToldTick& told) override {
    for (wire::ServerTick& chunk : cut(told, term_)) {
      chunk.follower(follower_.follower(servers_));
      write(ticks_, std::move(chunk));
    }
  }
  TakenTicks taken_up_to() override { return follower_.take(*follows_, term_, identities_.get()); }
  void await_taken(std::int64_t at_most_ns) override { takings_.await(at_most_ns); }

  /// Also a client that is still joining counts, so that nothing said meanwhile is lost.
  bool has_readers() const override {
    return matched(poses_) || matched(events_) || matched(pulses_);
  }
  ChannelCounters counters() const override {
    ChannelCounters counters = counters_;
    counters.malformed += participant_->refused() + leader_.dropped();
    counters.guard_dropped = participant_->dropped();
    counters.trailers_cut = participant_->cut();
    return counters;
  }

 private:
  /// What other servers tell; says whether one of them leads instead of us.
  bool take_told(std::vector<ToldTick>* ticks) {
    bool superseded = false;
    take_all<wire::ServerTick>(told_, [&](const wire::ServerTick& sample, const ClientKey& key) {
      superseded |= leader_.hear(sample, key, {term_, participant_->key()}, ticks);
    });
    return superseded;
  }

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
      const ClientKey key = client_key(info.sample_identity.writer_guid());
      if (identities_ && identities_->is_revoked(key) &&
          !(std::is_same_v<Sample, wire::ServerTick> && leader_.may_be_ending(key))) {
        ++counters_.foreign;
        if constexpr (std::is_same_v<Sample, wire::Request>) refuse_revoked(sample, key);
        continue;
      }
      action(sample, key);
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

  /// Fast DDS reads revocations once, when it begins: who is revoked later it lets stay, and come
  /// back. Here they go.
  void turn_away(ServerInput& input) {
    for (const ClientKey& key : identities_->newly_revoked()) {
      input.turned_away.push_back(identities_->whose(key) +
                                  (present_.erase(key) > 0
                                       ? " has been revoked: what comes from there is dropped"
                                       : " was not let in: it has been revoked"));
      input.lost.push_back({UserId{}, key, false});
    }
    for (std::string& text : doorman_.take_turned_away())
      input.turned_away.push_back(std::move(text));
    counters_.turned_away += input.turned_away.size();
    doorman_.tell_repeats(participant_->repeated(), input.turned_away);
  }
  /// Who asks to come in is told. Of anything else nobody can be: whose user it names, is not
  /// known.
  void refuse_revoked(const wire::Request& sample, const ClientKey& key) {
    if (sample.join().size() != 1) return;
    publish_join_reply(
        {key, sample.join()[0].nonce(), UserId{}, Refusal::kNotAllowed,
         identities_->whose(key) + " has been revoked; ask for a new one (mortise keys issue)"});
  }
  void take_requests(ServerInput& input) {
    take_all<wire::Request>(requests_, [&](const wire::Request& sample, const ClientKey& key) {
      Result<Request> request = from_wire(sample);
      if (!request) {
        ++counters_.malformed;
        if (sample.join().size() == 1)
          publish_join_reply({key, sample.join()[0].nonce(), UserId{}, Refusal::kNotAllowed,
                              request.error().text});
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
  ServersWatch servers_;
  NewsBell takings_;
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Heartbeat> beat_;  ///< after the participant, whose writer it speaks for
  std::uint64_t term_ = 0;           ///< 0 while another leads
  std::uint64_t led_until_ms_ = 0;   ///< DdsOptions
  LeaderTold leader_;
  FollowerTold follower_;
  dds::DataWriter *answers_ = nullptr, *poses_ = nullptr, *keyframes_ = nullptr, *events_ = nullptr,
                  *snapshots_ = nullptr, *meshes_ = nullptr, *features_ = nullptr,
                  *pulses_ = nullptr, *ticks_ = nullptr, *taken_ = nullptr;
  dds::DataReader *told_ = nullptr, *follows_ = nullptr, *presence_ = nullptr, *requests_ = nullptr,
                  *increments_ = nullptr;
  std::uint64_t pose_serial_ = 0, keyframe_serial_ = 0, snapshot_serial_ = 0, feature_serial_ = 0;
  std::size_t mesh_chunks_ = 0;
  std::map<UserId, ClientKey> joined_;
  std::set<ClientKey> present_;
  ChannelCounters counters_;
};

}  // namespace

Result<std::unique_ptr<StandbyChannel>> open_standby_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsServerChannel>();
  if (Status opened = channel->stand_by(options); !opened) return opened.error();
  return std::unique_ptr<StandbyChannel>(std::move(channel));
}

Result<std::unique_ptr<ServerChannel>> open_server_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsServerChannel>();
  if (Status opened = channel->open(options); !opened) return opened.error();
  return std::unique_ptr<ServerChannel>(std::move(channel));
}

}  // namespace mortise
