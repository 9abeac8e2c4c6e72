#include "idl/following.h"

#include <pthread.h>

#include <stop_token>

namespace mortise {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

ClientKey key_of(const rtps::InstanceHandle_t& handle) {
  return client_key(rtps::iHandle2GUID(handle));
}

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

bool PeerServers::is_alive(const ClientKey& server) const {
  const std::lock_guard lock(mutex_);
  return alive_.contains(server);
}

bool PeerServers::has_follower() const {
  const std::lock_guard lock(mutex_);
  return !followers_.empty();
}

bool PeerServers::follows(const ClientKey& server) const {
  const std::lock_guard lock(mutex_);
  return followers_.contains(server);
}

bool PeerServers::take_came() {
  const std::lock_guard lock(mutex_);
  return std::exchange(came_, false);
}

void PeerServers::on_liveliness_changed(dds::DataReader*,
                                        const dds::LivelinessChangedStatus& status) {
  const std::lock_guard lock(mutex_);
  const ClientKey server = key_of(status.last_publication_handle);
  if (status.alive_count_change > 0) alive_.insert(server);
  if (status.alive_count_change < 0) alive_.erase(server);
}

void PeerServers::on_subscription_matched(dds::DataReader*,
                                          const dds::SubscriptionMatchedStatus& status) {
  const std::lock_guard lock(mutex_);
  if (status.current_count_change < 0) alive_.erase(key_of(status.last_publication_handle));
}

void PeerServers::on_publication_matched(dds::DataWriter*,
                                         const dds::PublicationMatchedStatus& status) {
  const std::lock_guard lock(mutex_);
  const ClientKey server = key_of(status.last_subscription_handle);
  if (server == own_ || status.current_count_change == 0) return;
  if (status.current_count_change < 0) followers_.erase(server);
  if (status.current_count_change > 0) followers_.insert(server);
  came_ = came_ || status.current_count_change > 0;
}

LeaderTold::Heard LeaderTold::hear(const wire::ServerTick& sample, const ClientKey& key,
                                   const std::pair<std::uint64_t, ClientKey>& own) {
  const std::pair rank(sample.term(), key);
  if (key == own.second || rank < std::pair(term_, leader_)) return {};
  term_ = sample.term();
  leader_ = key;
  counts_on_ = sample.follower();
  return {collector_.add(sample), own.first != 0 && rank > own};
}

bool LeaderTold::may_be_ending(const ClientKey& revoked) {
  // Lists are looked at each second, and come one after the other.
  constexpr std::chrono::seconds kMayTake(5);
  const auto now = std::chrono::steady_clock::now();
  if (std::exchange(revoked_, revoked) != revoked) revoked_at_ = now;
  return revoked == leader_ && now - revoked_at_ < kMayTake;
}

TakenTicks FollowerTold::take(dds::DataReader& reader, std::uint64_t term,
                              const PeerServers& servers, Participant& own,
                              const PeerIdentities* identities) {
  TakenTicks taken;
  take_all<wire::ServerTaken>(reader,
                              [&](const wire::ServerTaken& sample, const rtps::GUID_t& writer) {
                                own.note_spoke(writer);
                                if (sample.term() != term) return;
                                const ClientKey key = client_key(writer);
                                if (identities != nullptr && identities->is_revoked(key)) {
                                  if (key == follower_) follower_.clear();
                                  return;
                                }
                                if (follower_.empty() && servers.follows(key)) follower_ = key;
                                if (key != follower_ || sample.tick() < taken.received) return;
                                taken = {sample.tick(), sample.computed(), key};
                              });
  return taken;
}

const ClientKey& FollowerTold::follower(const PeerServers& servers) {
  if (!servers.follows(follower_)) follower_.clear();
  return follower_;
}

Heartbeat::Heartbeat(dds::DataWriter& writer)
    : thread_([this, &writer](const std::stop_token& stop) {
        constexpr std::chrono::duration<double> kPeriod(kLeaderAssert_s);
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
          if (ticks_go_on()) writer.assert_liveliness();
          stopped_.wait_for(lock, stop, kPeriod, [] { return false; });
        }
      }) {}

void Heartbeat::progress(double next_within_s) {
  const std::lock_guard lock(watched_);
  if (!has_clock_) has_clock_ = pthread_getcpuclockid(pthread_self(), &cpu_clock_) == 0;
  watch_.progress(seconds_of(CLOCK_MONOTONIC), next_within_s);
}

bool Heartbeat::ticks_go_on() {
  const std::lock_guard lock(watched_);
  return watch_.advances(seconds_of(CLOCK_MONOTONIC), has_clock_ ? seconds_of(cpu_clock_) : 0.0);
}

}  // namespace mortise
