#pragma once
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "idl/participant.h"

namespace mortise {

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
      unproven_.erase(client);
    } else if (identities_) {
      const std::string subject = announced(info, "dds.cert.sn");
      if (!subject.empty()) identities_->met(client, subject);
      const std::lock_guard lock(mutex_);
      unproven_.emplace(client,
                        Unproven{Time::clock::now(),
                                 identities_->why_not(subject, announced(info, "dds.ca.sn"))});
    }
  }
  void onParticipantAuthentication(dds::DomainParticipant*,
                                   rtps::ParticipantAuthenticationInfo&& info) override {
    const std::lock_guard lock(mutex_);
    const ClientKey client = client_key(info.guid);
    Unproven& unproven = unproven_[client];
    unproven.since = Time::max();  // answered, either way
    if (info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT)
      turn_away(client, unproven);
  }
  /// What an observer would send is not heard, whatever its own end lets pass: its permissions have
  /// no increments. Nobody can tell it so.
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    if (!identities_ || info.status != rtps::WriterDiscoveryInfo::DISCOVERED_WRITER ||
        info.info.topicName().to_string() != row_of(Topic::kIncrement).topic)
      return;
    const ClientKey client = client_key(info.info.guid());
    const std::optional<Identity> identity = identities_->identity_of(client);
    if (!identity || identity->role != "observer") return;
    const std::lock_guard lock(mutex_);
    turned_away_.push_back(identities_->whose(client) +
                           " does not let its owner send increments: none is heard");
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
  /// Who was not let in since, and why, in words. Also those of whom nothing was proven in time:
  /// where the other end is to begin the handshake and does not like our certificate, nobody tells
  /// us. Not who is revoked: PeerIdentities tells of them.
  std::vector<std::string> take_turned_away() {
    constexpr auto kTimeToProve = std::chrono::seconds(2);
    const std::lock_guard lock(mutex_);
    for (auto& [client, unproven] : unproven_) {
      if (unproven.since == Time::max() || Time::clock::now() - unproven.since < kTimeToProve)
        continue;
      unproven.since = Time::max();  // said once
      turn_away(client, unproven);
    }
    return std::exchange(turned_away_, {});
  }
  /// Says how many encrypted datagrams came a second time, once a second, if any did; `in_all`: of
  /// the whole session. For one thread.
  void tell_repeats(std::uint64_t in_all, std::vector<std::string>& texts) {
    const Time now = Time::clock::now();
    if (in_all == repeats_told_ || now - repeats_told_at_ < std::chrono::seconds(1)) return;
    repeats_told_at_ = now;
    texts.push_back(std::to_string(in_all - std::exchange(repeats_told_, in_all)) +
                    " encrypted datagrams came a second time and were dropped: a recording, or a "
                    "net that doubles");
  }
  void know(PeerIdentities* identities) { identities_ = identities; }

 private:
  void add(const rtps::GUID_t& guid) {
    const std::lock_guard lock(mutex_);
    gone_.push_back(client_key(guid));
  }

  struct Unproven {
    Time since = Time::max();  ///< max: proven, or said
    std::string why;
  };
  void turn_away(const ClientKey& client, const Unproven& unproven) {
    if (identities_->is_revoked(client)) return;
    turned_away_.push_back(identities_->whose(client) + " was not let in: " + unproven.why);
  }

  std::mutex mutex_;
  std::vector<ClientKey> gone_;
  std::vector<std::string> turned_away_;
  std::map<ClientKey, Unproven> unproven_;
  PeerIdentities* identities_ = nullptr;  ///< null: nobody proves anything
  std::uint64_t repeats_told_ = 0;
  Time repeats_told_at_{};
};

/// Hears which servers of the session tell ticks and are alive, and which listen to ours.
class ServersWatch final : public dds::DataReaderListener, public dds::DataWriterListener {
 public:
  void on_liveliness_changed(dds::DataReader*,
                             const dds::LivelinessChangedStatus& status) override {
    const std::lock_guard lock(mutex_);
    const ClientKey server = key_of(status.last_publication_handle);
    if (status.alive_count_change > 0) alive_.insert(server);
    if (status.alive_count_change < 0) alive_.erase(server);
  }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change < 0) alive_.erase(key_of(status.last_publication_handle));
  }
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    const std::lock_guard lock(mutex_);
    const ClientKey server = key_of(status.last_subscription_handle);
    if (server == own_ || status.current_count_change == 0) return;
    if (status.current_count_change < 0) followers_.erase(server);
    if (status.current_count_change > 0) followers_.insert(server);
    came_ = came_ || status.current_count_change > 0;
  }
  void know_own(const ClientKey& own) { own_ = own; }
  bool is_alive(const ClientKey& server) const {
    const std::lock_guard lock(mutex_);
    return alive_.contains(server);
  }
  bool has_follower() const {
    const std::lock_guard lock(mutex_);
    return !followers_.empty();
  }
  bool follows(const ClientKey& server) const {
    const std::lock_guard lock(mutex_);
    return followers_.contains(server);
  }
  bool take_came() {
    const std::lock_guard lock(mutex_);
    return std::exchange(came_, false);
  }

 private:
  static ClientKey key_of(const rtps::InstanceHandle_t& handle) {
    return client_key(rtps::iHandle2GUID(handle));
  }
  mutable std::mutex mutex_;
  std::set<ClientKey> alive_, followers_;
  ClientKey own_;
  bool came_ = false;
};

/// Says that the one that leads lives, however long its tick takes.
class Heartbeat {
 public:
  explicit Heartbeat(dds::DataWriter& writer)
      : thread_([&writer](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            writer.assert_liveliness();
            std::this_thread::sleep_for(std::chrono::duration<double>(kLeaderAssert_s));
          }
        }) {}

 private:
  std::jthread thread_;
};

/// Rings when a sample comes, in a thread of Fast DDS.
class NewsBell final : public dds::DataReaderListener {
 public:
  void on_data_available(dds::DataReader*) override {
    {
      const std::lock_guard lock(mutex_);
      rung_ = true;
    }
    bell_.notify_one();
  }
  /// Returns when it has rung since the last call, or after so long.
  void await(std::int64_t at_most_ns) {
    std::unique_lock lock(mutex_);
    bell_.wait_for(lock, std::chrono::nanoseconds(at_most_ns), [this] { return rung_; });
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable bell_;
  bool rung_ = false;
};

}  // namespace mortise
