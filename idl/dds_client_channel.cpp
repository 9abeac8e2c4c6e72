#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "idl/client_readers.h"
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
  Status open(const DdsOptions& options);

  void join(std::uint64_t nonce, const std::string& name, const std::string& role) override;
  void leave(UserId user) override;
  void heartbeat(UserId user) override;
  void send(const IncrementBatch& batch) override;
  void send(const Command& command) override;
  void request_snapshot() override;
  ClientInput take() override;
  ChannelCounters counters() const override;

 private:
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++send_failed_;
  }
  /// Says that this process lives, a few times within the lease.
  void assert_presence();
  void refuse_unsent(ClientInput& input);

  std::unique_ptr<PeerIdentities> identities_;  ///< null: no security
  ServerWatch watch_;                           // before the participant, whose threads call it
  ClientReaders readers_{watch_};
  std::unique_ptr<Participant> participant_;
  ClientKey key_;
  dds::DataWriter *presence_ = nullptr, *increments_ = nullptr, *requests_ = nullptr;
  Clock::duration assert_period_{};
  Clock::time_point asserted_at_{};
  std::uint64_t beat_ = 0;
  std::vector<RefusedIncrement> unsent_;  ///< an observer's, to be told with the next input
  bool lost_ = false;                     ///< to be told with the next input
  std::uint64_t send_failed_ = 0;
};

Status DdsClientChannel::open(const DdsOptions& options) {
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
  readers_.open(*participant_, options, status);
  participant_->open_writer<wire::PresencePubSubType>(Topic::kPresence, presence_, status, &watch_);
  // An observer's permissions have no increments.
  if (!participant_->identity() || participant_->identity()->role != "observer")
    participant_->open_writer<wire::IncrementBatchPubSubType>(Topic::kIncrement, increments_,
                                                              status, &watch_);
  participant_->open_writer<wire::RequestPubSubType>(Topic::kRequest, requests_, status, &watch_);
  readers_.open_answers(*participant_, status);
  return status;
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
  if (increments_ == nullptr) {
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

void DdsClientChannel::request_snapshot() {
  Request request;
  request.kind = Request::Kind::kSnapshot;
  write(requests_, to_wire(request));
}

ClientInput DdsClientChannel::take() {
  ClientInput input;
  input.server_lost = std::exchange(lost_, false);  // the input before had its last words
  readers_.take(key_, input);
  refuse_unsent(input);
  // Answers can be heard; and what is sent from now on will be.
  const ServerWatch::Answer watch = watch_.take(increments_ == nullptr ? 2 : 3);
  lost_ = watch.lost;
  input.server_present = watch.present && !lost_;
  return input;
}

ChannelCounters DdsClientChannel::counters() const {
  ChannelCounters counters = readers_.counters();
  counters.send_failed = send_failed_;
  counters.malformed += participant_->refused();
  counters.guard_dropped = participant_->dropped();
  counters.trailers_cut = participant_->cut();
  return counters;
}

void DdsClientChannel::assert_presence() {
  const Clock::time_point now = Clock::now();
  if (now - asserted_at_ < assert_period_) return;
  asserted_at_ = now;
  presence_->assert_liveliness();
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

Result<std::unique_ptr<ClientChannel>> open_client_channel(const DdsOptions& options) {
  auto channel = std::make_unique<DdsClientChannel>();
  if (Status opened = channel->open(options); !opened) return opened.error();
  return std::unique_ptr<ClientChannel>(std::move(channel));
}

}  // namespace mortise
