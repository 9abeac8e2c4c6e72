#include <algorithm>
#include <chrono>

#include "idl/chunks.h"
#include "idl/dds_channel.h"
#include "idl/following.h"
#include "idl/participant.h"
#include "idl/server_places.h"
#include "idl/server_readers.h"
#include "idl/server_writers.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

using Clock = std::chrono::steady_clock;

// One that leads tells a tick as soon as it sees us.
constexpr std::chrono::seconds kLookForLeader(2);
constexpr double kLastWords_s = 0.3;

std::int64_t ns_until(Clock::time_point end) {
  return std::chrono::nanoseconds(end - Clock::now()).count();
}

class DdsServerChannel final : public StandbyChannel {
 public:
  /// Says goodbye after its last words were heard; who does not listen is not waited for long.
  ~DdsServerChannel() override { writers_.await_heard(kLastWords_s); }
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
  void publish_poses(const PoseBatch& batch) override { writers_.say(batch); }
  void publish_events(std::span<const ClashEvent> events) override { writers_.say(events); }
  void publish_snapshot(const Snapshot& snapshot) override { writers_.say(snapshot); }
  void publish_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    writers_.say(hash, bytes);
  }
  void publish_features(const FeatureTable& table) override { writers_.say(table); }
  void publish_pulse(const SessionPulse& pulse) override { writers_.say(pulse); }
  bool has_readers() const override { return writers_.has_readers(); }
  ChannelCounters counters() const override;

  bool has_follower() const override { return servers_.has_follower(); }
  void publish_tick(const ToldTick& told) override;
  TakenTicks taken_up_to() override { return follower_.take(*follows_, term_, identities()); }
  void await_taken(std::int64_t at_most_ns) override { takings_.await(at_most_ns); }
  void lead_anew() override;
  std::uint64_t term_ms() const override { return term_; }
  std::string barred() const override;

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
  /// What other servers tell; says whether one of them leads instead of us.
  bool take_told(std::vector<ToldTick>* ticks);
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++readers_.counters().send_failed;
  }

  // Before the participant, whose threads call them.
  ServerWriters writers_;
  ServerReaders readers_{writers_};
  PeerServers servers_;
  SampleBell takings_;
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
      take_told(nullptr);
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
  term_ = next_term(std::max(leader_.term(), led_until_ms_));
  participant_->set_term(term_);
  if (Status opened = open_endpoints(); !opened) return opened;
  beat_ = std::make_unique<Heartbeat>(*ticks_);
  return told_ != nullptr ? ok() : listen_to_servers();
}

void DdsServerChannel::lead_anew() {
  term_ = next_term(term_);
  writers_.change_term(*participant_, term_);
}

std::string DdsServerChannel::barred() const {
  const std::optional<Identity>& own = participant_->identity();
  if (identities() == nullptr || !own || !identities()->is_revoked(*own)) return {};
  return "the certificate of '" + own->name +
         "' (server) has been revoked: this server ends; issue a new one with mortise keys";
}

Status DdsServerChannel::meet(const DdsOptions& options, Participant::Side side) {
  if (!options.keys.empty()) {
    const KeyFiles files(options.keys);
    readers_.know(std::make_unique<PeerIdentities>(files.authority, files.revocations));
  }
  auto participant = Participant::open(options, side, &readers_.doorman());
  if (!participant) return participant.error();
  participant_ = std::move(participant.value());
  led_until_ms_ = options.led_until_ms;
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
  participant_->open_reader<wire::ServerTakenPubSubType>(Topic::kTaken, &takings_, follows_,
                                                         status);
  readers_.open(*participant_, status);
  return status;
}

// 2. what it hears and says

ServerInput DdsServerChannel::take() {
  ServerInput input;
  readers_.turn_away(*participant_, input);
  input.follower_came = servers_.take_came();
  input.superseded = take_told(nullptr);
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
  std::vector<ToldTick> ticks;
  take_told(&ticks);
  return ticks;
}

void DdsServerChannel::confirm(const TakenTicks& taken) {
  wire::ServerTaken sample;
  sample.tick(taken.received);
  sample.term(leader_.term());
  sample.computed(taken.computed);
  write(taken_, sample);
}

bool DdsServerChannel::take_told(std::vector<ToldTick>* ticks) {
  bool superseded = false;
  take_all<wire::ServerTick>(*told_, [&](const wire::ServerTick& sample,
                                         const eprosima::fastrtps::rtps::GUID_t& writer) {
    ++readers_.counters().received;
    const ClientKey key = client_key(writer);
    if (identities() != nullptr && identities()->is_revoked(key) && !leader_.may_be_ending(key)) {
      ++readers_.counters().foreign;
      return;
    }
    superseded |= leader_.hear(sample, key, {term_, participant_->key()}, ticks);
  });
  return superseded;
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

}  // namespace mortise
