#include "idl/fast_dds_overrides.h"

#include <dlfcn.h>
#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <fastrtps/config.h>
#include <fastdds/rtps/common/GuidPrefix_t.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

static_assert(FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9 &&
                  FASTRTPS_VERSION_MICRO == 1,
              "another Fast DDS: see whether its functions below still do what their header says; "
              "if not, drop them");

namespace {

constexpr double kLookAgain_ms = 5.0;  // much shorter than a lease, longer than what holds the lock
// An announcement that comes while its sender is removed makes it one that is met, of which the
// rest of the removal takes what keys know: it is never asked again who it is. So one that still
// announces itself, each 500 ms, is removed between two announcements: so long after the last one.
constexpr double kAfterAnnouncement_ms = 50.0, kBeforeNext_ms = 350.0, kLookBetween_ms = 150.0;

struct Uses {
  std::atomic<std::uint64_t> lease_checks = 0, encodings = 0, session_keys = 0;
};
Uses uses;
void count(std::atomic<std::uint64_t>& use) { use.fetch_add(1, std::memory_order_relaxed); }

using Prefix = eprosima::fastrtps::rtps::GuidPrefix_t;

/// What a participant of this process knows of its peers.
struct Peers {
  std::weak_ptr<mortise::PeerRemovals> removals;
  std::weak_ptr<mortise::PeersHeard> heard;
};

class AllPeers {
 public:
  void add(const Prefix& own, Peers peers) {
    const std::lock_guard lock(mutex_);
    std::erase_if(peers_, [](const auto& entry) { return entry.second.removals.expired(); });
    peers_[own] = std::move(peers);
  }
  Peers of(const Prefix& own) {
    const std::lock_guard lock(mutex_);
    const auto found = peers_.find(own);
    return found == peers_.end() ? Peers{} : found->second;
  }

 private:
  std::mutex mutex_;
  std::map<Prefix, Peers> peers_;
};
AllPeers& all_peers() {
  static auto* all = new AllPeers;  // threads of the library may ask while the process ends
  return *all;
}

}  // namespace

namespace eprosima::fastrtps::rtps {

namespace {

using Left = std::chrono::duration<double, std::milli>;

// Of the lease.
Left left_of(const ParticipantProxyData& remote) {
  return remote.last_received_message_tm() + remote.lease_duration() -
         std::chrono::steady_clock::now();
}

void look_after(const ParticipantProxyData& remote, Left wait) {
  remote.lease_duration_event->update_interval_millisec(wait.count());
  remote.lease_duration_event->restart_timer();
}

// Whoever stood still finds all leases ended before it has taken what was sent meanwhile. With keys
// that is no reason to go on: the other has forgotten us, too, and both begin anew.
bool was_heard_meanwhile(PDP& discovery, const GUID_t& guid) {
  const std::lock_guard<std::recursive_mutex> lock(*discovery.getMutex());
  const auto found =
      std::find_if(discovery.ParticipantProxiesBegin(), discovery.ParticipantProxiesEnd(),
                   [&](const ParticipantProxyData* remote) { return remote->m_guid == guid; });
  if (found == discovery.ParticipantProxiesEnd() || left_of(**found).count() < 0.0) return false;
  look_after(**found, left_of(**found));
  return true;
}

}  // namespace

// Called by a timer of each remote participant. Whoever has left has no GUID any more, and nothing
// is to be done. The thread of the timers does not wait here for whoever may wait for it.
void PDP::check_remote_participant_liveliness(ParticipantProxyData* remote_participant) {
  count(uses.lease_checks);
  ParticipantProxyData& remote = *remote_participant;
  std::unique_lock<std::recursive_mutex> lock(*getMutex(), std::try_to_lock);
  if (!lock) return look_after(remote, Left(kLookAgain_ms));
  if (!remote.should_check_lease_duration || remote.m_guid == GUID_t::unknown()) return;
  const Left left = left_of(remote);
  const GUID_t guid = remote.m_guid;
  const bool has_own = ParticipantProxiesBegin() != ParticipantProxiesEnd();  // the first is it
  const Peers known =
      has_own ? all_peers().of(getLocalParticipantProxyData()->m_guid.guidPrefix) : Peers{};
  const auto heard = known.heard.lock();
  const auto peer = std::bit_cast<mortise::PeersHeard::Prefix>(guid.guidPrefix.value);
  const bool is_silent = heard && heard->is_silent(peer);
  const Left since = Left(remote.lease_duration()) - left;
  if (left.count() >= 0.0 && is_silent &&
      (since.count() < kAfterAnnouncement_ms || since.count() > kBeforeNext_ms))
    return look_after(remote, Left(kLookBetween_ms));
  if (left.count() < 0.0 || is_silent) {
    if (heard) heard->part(peer);
    lock.unlock();
    const auto remove = [this, guid, may_go_on = heard == nullptr] {
      if (may_go_on && was_heard_meanwhile(*this, guid)) return;
      remove_remote_participant(guid, ParticipantDiscoveryInfo::DROPPED_PARTICIPANT);
    };
    if (const auto removals = known.removals.lock())
      removals->add(remove);
    else
      remove();
    return;
  }
  look_after(remote, left);
}

}  // namespace eprosima::fastrtps::rtps

namespace mortise {

using eprosima::fastrtps::rtps::CDRMessage_t;
using eprosima::fastrtps::rtps::GuidPrefix_t;
using Receivers = std::vector<GuidPrefix_t>;
using Key = std::array<std::uint8_t, 32>;

// No installed header declares the classes of which these are members: names are all there is.
bool encode_for_somebody(const void* manager, const CDRMessage_t& plain, CDRMessage_t& encoded,
                         const Receivers& receivers) __asm__(MORTISE_ENCODE);
void kept_session_key(void* transform, Key& session_key, bool receiver_specific, const Key& master,
                      const Key& salt, std::uint32_t session,
                      int length) __asm__(MORTISE_SESSION_KEY);

namespace {

/// What the library has under the name.
template <class Function>
Function* library_s(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool is_own(const char* name) {
  void* found = dlsym(RTLD_DEFAULT, name);
  Dl_info of_found, of_own;
  return found != nullptr && dladdr(found, &of_found) != 0 &&
         dladdr(reinterpret_cast<const void*>(&is_own), &of_own) != 0 &&
         of_found.dli_fbase == of_own.dli_fbase;
}

struct SessionKey {
  Key master{}, salt{}, key{};
  std::uint32_t session = 0;
  int length = 0;  // 0: none is kept here
  bool receiver_specific = false;
};

/// One place for each of what is kept; another that falls on it takes it. So datagrams with numbers
/// of sessions that never were cost what they cost the library, and no memory.
struct SessionKeys {
  /// Chosen: a few for each of the peers of a large session.
  static constexpr std::size_t kPlaces = 1024;

  SessionKey& place_of(const Key& master, std::uint32_t session) {
    std::uint64_t bits;  // a master key is random
    std::memcpy(&bits, master.data(), sizeof bits);
    return places[(bits ^ session) % kPlaces];
  }

  std::mutex mutex;
  std::array<SessionKey, kPlaces> places;
};

}  // namespace

// Called where a message is about to be sent. False: it is not sent.
bool encode_for_somebody(const void* manager, const CDRMessage_t& plain, CDRMessage_t& encoded,
                         const Receivers& receivers) {
  count(uses.encodings);
  if (receivers.empty()) return false;
  static auto* const encode = library_s<decltype(encode_for_somebody)>(MORTISE_ENCODE);
  return encode != nullptr && encode(manager, plain, encoded, receivers);
}

void kept_session_key(void* transform, Key& session_key, bool receiver_specific, const Key& master,
                      const Key& salt, std::uint32_t session, int length) {
  count(uses.session_keys);
  static SessionKeys keys;
  const std::lock_guard<std::mutex> lock(keys.mutex);
  SessionKey& kept = keys.place_of(master, session);
  if (kept.length != length || kept.session != session ||
      kept.receiver_specific != receiver_specific || kept.master != master || kept.salt != salt) {
    static auto* const compute = library_s<decltype(kept_session_key)>(MORTISE_SESSION_KEY);
    session_key = {};
    compute(transform, session_key, receiver_specific, master, salt, session, length);
    if (session_key == Key{}) return;  // it failed; the next datagram may fare better
    kept = {master, salt, session_key, session, length, receiver_specific};
  }
  session_key = kept.key;
}

void know_peers(const GuidPrefix_t& own, const std::shared_ptr<PeerRemovals>& removals,
                const std::shared_ptr<PeersHeard>& peers) {
  all_peers().add(own, {removals, peers});
}

bool overrides_in_force() {
  return is_own(MORTISE_LEASE_CHECK) && is_own(MORTISE_ENCODE) && is_own(MORTISE_SESSION_KEY);
}

OverrideUses override_uses() {
  return {uses.lease_checks.load(), uses.encodings.load(), uses.session_keys.load()};
}

}  // namespace mortise
