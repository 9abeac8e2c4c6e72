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
    if (server == own_) return;
    followers_ += status.current_count_change;
    came_ = came_ || status.current_count_change > 0;
  }
  void know_own(const ClientKey& own) { own_ = own; }
  bool is_alive(const ClientKey& server) const {
    const std::lock_guard lock(mutex_);
    return alive_.contains(server);
  }
  bool has_follower() const {
    const std::lock_guard lock(mutex_);
    return followers_ > 0;
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
  std::set<ClientKey> alive_;
  ClientKey own_;
  int followers_ = 0;
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
