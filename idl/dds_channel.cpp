#include "idl/dds_channel.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "idl/chunks.h"
#include "idl/client_readers.h"
#include "idl/convert.h"
#include "idl/following.h"
#include "idl/participant.h"
#include "idl/server_places.h"
#include "idl/server_readers.h"
#include "idl/server_watch.h"
#include "idl/server_writers.h"
#include "idl/terms.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

using Clock = std::chrono::steady_clock;

// One that leads tells a tick as soon as it sees us.
constexpr std::chrono::seconds kLookForLeader(2);
constexpr double kLastWords_s = 0.3;
// With keys, a client that met no server again opens a participant anew: first after so long, which
// is beyond the 4 s in which a user is taken back from the same participant, then twice as long
// each time, so that a slow handshake comes to its end.
constexpr std::chrono::seconds kMeetAnewFirst(5), kMeetAnewLast(80);

std::int64_t ns_until(Clock::time_point end) {
  return std::chrono::nanoseconds(end - Clock::now()).count();
}

// ---- the end of a server

class DdsServerChannel final : public StandbyChannel {
 public:
  /// Says goodbye after its last words were heard; who does not listen is not waited for long.
  ~DdsServerChannel() override { writers_.close(kLastWords_s); }
  /// Of a server that leads from now on.
  Status open(const DdsOptions& options);
  Status stand_by(const DdsOptions& options);

  ServerInput take() override;
  void publish_join_reply(const JoinReply& reply) override;
  void publish_replies(std::span<const Reply> replies) override { writers_.say(replies); }
  void publish_decisions(std::span<const Decision> decisions) override { writers_.say(decisions); }
  void publish_standing(std::span<const StandingChange> changes) override { writers_.say(changes); }
  void publish_refusals(std::span<const RefusedIncrement> refused) override {
    writers_.say(refused);
  }
  void publish_uploads(std::span<const UploadState> uploads) override { writers_.say(uploads); }
  void publish_poses(const PoseBatch& batch) override { writers_.say(batch); }
  void publish_events(std::span<const ClashEvent> events) override { writers_.say(events); }
  void publish_snapshot(Snapshot snapshot) override { writers_.say(std::move(snapshot)); }
  void publish_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    writers_.say(hash, bytes);
  }
  void publish_coming_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    writers_.say(hash, bytes);
  }
  void publish_features(const FeatureTable& table) override { writers_.say(table); }
  void publish_pulse(const SessionPulse& pulse) override { writers_.say(pulse); }
  bool has_readers() const override { return writers_.has_readers(); }
  ChannelCounters counters() const override;

  bool has_follower() const override { return servers_.has_follower(); }
  void publish_tick(const ToldTick& told) override;
  TakenTicks taken_up_to() override {
    return follower_.take(*follows_, term_, servers_, *participant_, identities());
  }
  void await_taken(std::int64_t at_most_ns) override { takings_.await(at_most_ns); }
  void note_progress(double next_within_s) override {
    if (beat_) beat_->progress(next_within_s);
  }
  void lead_anew() override;
  std::uint64_t term_ms() const override { return term_; }
  std::string barred() const override;
  ClientKey own_key() const override { return participant_->key(); }

  std::vector<ToldTick> follow() override;
  void await_told(std::int64_t at_most_ns) override { servers_.await_told(at_most_ns); }
  void confirm(const TakenTicks& taken) override;
  bool leader_present() const override { return servers_.is_alive(leader_.leader()); }
  bool another_stands_by() const override {
    return !leader_.counts_on().empty() && leader_.counts_on() != participant_->key();
  }
  Status take_over() override;

 private:
  Status meet(const DdsOptions& options, Participant::Side side);
  Status listen_to_servers();
  Status open_endpoints();
  const PeerIdentities* identities() const { return readers_.identities(); }
  /// What other servers tell, of those that lead. `input`, which may be null, hears whether one of
  /// them leads instead of us.
  std::vector<ToldTick> take_told(ServerInput* input);
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++readers_.counters().send_failed;
  }

  // Before the participant, whose threads call them.
  ServerWriters writers_;
  ServerReaders readers_{writers_};
  PeerServers servers_;
  Bell takings_;
  Inlet takings_inlet_{takings_};
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Heartbeat> beat_;  ///< after the participant, whose writer it speaks for
  std::uint64_t term_ = 0;           ///< 0 while another leads
  std::uint64_t led_until_ms_ = 0;   ///< DdsOptions
  LeaderTold leader_;
  FollowerTold follower_;
  dds::DataWriter *ticks_ = nullptr, *taken_ = nullptr;
  dds::DataReader *told_ = nullptr, *follows_ = nullptr;
};

// 1. how it comes to lead

Status DdsServerChannel::open(const DdsOptions& options) {
  if (Status met = meet(options, Participant::Side::kServer); !met) return met;
  if (may_have_another_server(options)) {
    if (Status listening = listen_to_servers(); !listening) return listening;
    const Clock::time_point end = Clock::now() + kLookForLeader;
    while (leader_.leader().empty() && Clock::now() < end) {
      servers_.await_told(ns_until(end));
      (void)take_told(nullptr);
    }
    if (!leader_.leader().empty())
      return fail(Code::kRuntime, "another server leads session '" + options.session +
                                      "'; start this one with --standby-of " + options.session);
  }
  return take_over();
}

Status DdsServerChannel::stand_by(const DdsOptions& options) {
  if (Status met = meet(options, Participant::Side::kStandby); !met) return met;
  Status status = listen_to_servers();
  participant_->open_writer<wire::ServerTakenPubSubType>(Topic::kTaken, taken_, status);
  return status;
}

Status DdsServerChannel::take_over() {
  term_ = leader_.term() != 0 ? term_of_successor(leader_.term()) : next_term(led_until_ms_);
  participant_->set_term(term_);
  if (Status opened = open_endpoints(); !opened) return opened;
  beat_ = std::make_unique<Heartbeat>(*ticks_);
  return told_ != nullptr ? ok() : listen_to_servers();
}

void DdsServerChannel::lead_anew() {
  term_ = term_led_anew(term_);
  writers_.change_term(*participant_, term_);
}

std::string DdsServerChannel::barred() const {
  const std::optional<Identity>& own = participant_->identity();
  if (identities() == nullptr || !own || !identities()->is_revoked(*own)) return {};
  return "the certificate of '" + own->name +
         "' (server) has been revoked: this server ends; issue a new one with mortise keys";
}

Status DdsServerChannel::meet(const DdsOptions& options, Participant::Side side) {
  readers_.doorman().leaders().look_for(options.session);
  if (!options.keys.empty()) {
    const KeyFiles files(options.keys);
    readers_.know(std::make_unique<PeerIdentities>(files.authority, files.revocations));
  }
  auto participant = Participant::open(options, side, &readers_.doorman());
  if (!participant) return participant.error();
  participant_ = std::move(participant.value());
  led_until_ms_ = std::min(options.led_until_ms, kLatestTerm_ms);
  servers_.know_own(participant_->key());
  return ok();
}

Status DdsServerChannel::listen_to_servers() {
  Status status = ok();
  participant_->open_reader<wire::ServerTickPubSubType>(Topic::kTick, &servers_, told_, status);
  return status;
}

Status DdsServerChannel::open_endpoints() {
  Status status = ok();
  // The writers first: who is heard can be answered.
  writers_.open(*participant_, status);
  participant_->open_writer<wire::ServerTickPubSubType>(Topic::kTick, ticks_, status, &servers_);
  participant_->open_reader<wire::ServerTakenPubSubType>(Topic::kTaken, &takings_inlet_, follows_,
                                                         status);
  readers_.open(*participant_, status);
  return status;
}

// 2. what it hears and says

ServerInput DdsServerChannel::take() {
  ServerInput input;
  readers_.turn_away(*participant_, input);
  input.follower_came = servers_.take_came();
  (void)take_told(&input);
  readers_.take(input);
  return input;
}

void DdsServerChannel::publish_join_reply(const JoinReply& reply) {
  if (reply.refusal == Refusal::kNone && reply.user) readers_.note_joined(reply.user, reply.client);
  writers_.say(reply);
}

ChannelCounters DdsServerChannel::counters() const {
  ChannelCounters counters = readers_.counters();
  counters.send_failed += writers_.failed();
  counters.malformed += participant_->refused() + leader_.dropped();
  counters.guard_dropped = participant_->dropped();
  counters.trailers_cut = participant_->cut();
  return counters;
}

// 3. among the servers of the session

void DdsServerChannel::publish_tick(const ToldTick& told) {
  for (wire::ServerTick& chunk : cut(told, term_)) {
    chunk.follower(follower_.follower(servers_));
    write(ticks_, std::move(chunk));
  }
}

std::vector<ToldTick> DdsServerChannel::follow() {
  ServerInput nobody;
  readers_.turn_away(*participant_, nobody);  // the one that leads may be revoked, too
  return take_told(nullptr);
}

void DdsServerChannel::confirm(const TakenTicks& taken) {
  wire::ServerTaken sample;
  sample.tick(taken.received);
  sample.term(leader_.term());
  sample.computed(taken.computed);
  write(taken_, sample);
}

std::vector<ToldTick> DdsServerChannel::take_told(ServerInput* input) {
  std::vector<ToldTick> ticks;
  const LeadersMet& leaders = readers_.doorman().leaders();
  take_all<wire::ServerTick>(
      *told_, [&](const wire::ServerTick& sample, const eprosima::fastrtps::rtps::GUID_t& writer) {
        ++readers_.counters().received;
        const ClientKey key = client_key(writer);
        participant_->note_spoke(writer);
        const bool is_revoked =
            identities() != nullptr && identities()->is_revoked(key) && !leader_.may_be_ending(key);
        if (is_revoked || !leaders.contains(key) || sample.term() > kLatestTerm_ms) {
          if (key != participant_->key()) ++readers_.counters().foreign;
          return;
        }
        LeaderTold::Heard heard = leader_.hear(sample, key, {term_, participant_->key()});
        if (!heard.tick) return;
        if (heard.superseding && input != nullptr) {
          input->superseded = true;
          input->superseded_by = leaders.where(key);
          input->superseding = *heard.tick;
        }
        ticks.push_back(std::move(*heard.tick));
      });
  return ticks;
}

// ---- the end of a client

class DdsClientChannel final : public ClientChannel {
 public:
  Status open(const DdsOptions& options);

  void join(std::uint64_t nonce, const std::string& name, const std::string& role) override;
  void leave(UserId user) override;
  void heartbeat(UserId user) override;
  void send(const IncrementBatch& batch) override;
  void send(const Command& command) override;
  void send(const UploadPiece& piece) override;
  void request_snapshot() override;
  ClientInput take() override;
  void await_input(std::int64_t at_most_ns) override { arrivals_.await(at_most_ns); }
  ChannelCounters counters() const override;

 private:
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (writer == nullptr || !writer->write(&sample)) ++send_failed_;
  }
  Status open_participant();
  void close_participant();
  /// Where the server and this client were parted for longer than a lease, Fast DDS 2.9.1 may keep
  /// a rest of one that it removed, and then answers its handshakes never again. Nobody has a rest
  /// of a participant that is new.
  void meet_anew_if_alone(bool alone);
  /// Says that this process lives, a few times within the lease.
  void assert_presence();
  void refuse_unsent(ClientInput& input);

  DdsOptions options_;
  std::unique_ptr<PeerIdentities> identities_;  ///< null: no security
  Bell arrivals_;                               // these before the participant, whose threads call
  ServerWatch watch_{arrivals_};
  std::unique_ptr<ClientReaders> readers_;
  std::unique_ptr<Participant> participant_;  ///< null: could not be opened anew, is tried again
  ClientKey key_;
  bool moves_ = true;  ///< an observer's permissions have no increments
  dds::DataWriter *presence_ = nullptr, *increments_ = nullptr, *requests_ = nullptr;
  Clock::duration assert_period_{};
  Clock::time_point asserted_at_{};
  std::uint64_t beat_ = 0;
  std::vector<RefusedIncrement> unsent_;  ///< an observer's, to be told with the next input
  bool lost_ = false;                     ///< to be told with the next input
  std::uint64_t send_failed_ = 0;
  std::optional<Clock::time_point> alone_since_;  ///< none: a server is met
  Clock::duration meet_anew_after_ = kMeetAnewFirst;
  bool was_met_ = false;    ///< a server
  ChannelCounters before_;  ///< of participants before this one
};

Status DdsClientChannel::open(const DdsOptions& options) {
  options_ = options;
  watch_.look_for(options.session);
  if (!options.keys.empty()) {
    const KeyFiles files(options.keys);
    identities_ = std::make_unique<PeerIdentities>(files.authority, files.revocations);
    watch_.know(identities_.get());
  }
  assert_period_ = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(0.25 * options.liveliness_lease_s));
  return open_participant();
}

Status DdsClientChannel::open_participant() {
  auto participant = Participant::open(options_, Participant::Side::kClient, &watch_);
  if (!participant) return participant.error();
  participant_ = std::move(participant.value());
  key_ = participant_->key();
  moves_ = !participant_->identity() || participant_->identity()->role != "observer";
  Status status = ok();
  readers_ = std::make_unique<ClientReaders>(watch_, arrivals_);
  readers_->open(*participant_, options_, status);
  participant_->open_writer<wire::PresencePubSubType>(Topic::kPresence, presence_, status, &watch_);
  if (moves_)
    participant_->open_writer<wire::IncrementBatchPubSubType>(Topic::kIncrement, increments_,
                                                              status, &watch_);
  participant_->open_writer<wire::RequestPubSubType>(Topic::kRequest, requests_, status, &watch_);
  readers_->open_answers(*participant_, status);
  return status;
}

void DdsClientChannel::meet_anew_if_alone(bool alone) {
  if (!alone) {
    alone_since_.reset();
    meet_anew_after_ = kMeetAnewFirst;
    return;
  }
  if (options_.keys.empty() || !was_met_) return;
  const Clock::time_point now = Clock::now();
  if (!alone_since_) alone_since_ = now;
  if (now - *alone_since_ < meet_anew_after_) return;
  alone_since_ = now;
  meet_anew_after_ = std::min<Clock::duration>(2 * meet_anew_after_, kMeetAnewLast);
  before_ = counters();
  close_participant();
  if (!open_participant()) close_participant();
}

void DdsClientChannel::close_participant() {
  participant_.reset();  // first: its threads call the readers
  readers_.reset();
  presence_ = increments_ = requests_ = nullptr;
  watch_.part_from_all();
}

void DdsClientChannel::join(std::uint64_t nonce, const std::string& name, const std::string& role) {
  assert_presence();
  Request request;
  request.kind = Request::Kind::kJoin;
  request.nonce = nonce;
  request.name = name;
  request.role = role;
  write(requests_, to_wire(request));
}

void DdsClientChannel::leave(UserId user) {
  Request request;
  request.kind = Request::Kind::kLeave;
  request.command.user = user;
  write(requests_, to_wire(request));
}

void DdsClientChannel::heartbeat(UserId user) {
  wire::Presence sample;
  sample.user(user.value);
  sample.beat(++beat_);
  write(presence_, sample);
  asserted_at_ = Clock::now();
}

void DdsClientChannel::send(const IncrementBatch& batch) {
  assert_presence();
  if (!moves_) {
    ++send_failed_;
    for (const auto& [increment, sent_ns] : batch.increments)
      unsent_.push_back({increment.user, increment.part, increment.seq, Refusal::kObserver});
    return;
  }
  write(increments_, to_wire(batch));
}

void DdsClientChannel::send(const Command& command) {
  assert_presence();
  Request request;
  request.kind = Request::Kind::kCommand;
  request.command = command;
  write(requests_, to_wire(request));
}

void DdsClientChannel::send(const UploadPiece& piece) {
  assert_presence();
  Request request;
  request.kind = Request::Kind::kUpload;
  request.piece = piece;
  write(requests_, to_wire(request));
}

void DdsClientChannel::request_snapshot() {
  Request request;
  request.kind = Request::Kind::kSnapshot;
  write(requests_, to_wire(request));
}

ClientInput DdsClientChannel::take() {
  ClientInput input;
  input.server_lost = std::exchange(lost_, false);  // the input before had its last words
  if (readers_) readers_->take(key_, input);
  refuse_unsent(input);
  // Answers can be heard; and what is sent from now on will be.
  const ServerWatch::Answer watch = watch_.take(moves_ ? 3 : 2);
  lost_ = watch.lost;
  input.server_present = watch.present && !lost_;
  was_met_ |= input.server_present;
  meet_anew_if_alone(watch.alone);
  return input;
}

ChannelCounters DdsClientChannel::counters() const {
  ChannelCounters counters = before_;
  counters.send_failed = send_failed_;
  if (participant_ == nullptr) return counters;
  const ChannelCounters heard = readers_->counters();
  counters.received += heard.received;
  counters.foreign += heard.foreign;
  counters.lost += heard.lost;
  counters.malformed += heard.malformed + participant_->refused();
  counters.guard_dropped += participant_->dropped();
  counters.trailers_cut += participant_->cut();
  return counters;
}

void DdsClientChannel::assert_presence() {
  const Clock::time_point now = Clock::now();
  if (now - asserted_at_ < assert_period_) return;
  asserted_at_ = now;
  if (presence_ != nullptr) presence_->assert_liveliness();
}

// Of an observer with keys: as a server answers one without, lest it is sent again for ever.
void DdsClientChannel::refuse_unsent(ClientInput& input) {
  PoseBatch answered;
  for (const RefusedIncrement& refused : unsent_)
    answered.acks.push_back({refused.user, refused.seq, 0});
  if (!unsent_.empty()) input.poses.push_back(std::move(answered));
  input.refused.insert(input.refused.end(), unsent_.begin(), unsent_.end());
  unsent_.clear();
}

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

Result<std::unique_ptr<ClientChannel>> open_client_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsClientChannel>();
  if (Status opened = channel->open(options); !opened) return opened.error();
  return std::unique_ptr<ClientChannel>(std::move(channel));
}

}  // namespace mortise
