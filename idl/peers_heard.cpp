#include "idl/peers_heard.h"

#include <cstring>

#include "idl/rtps_bytes.h"

namespace mortise {
namespace {

// In the header of RTPS, behind its name, version and vendor; and the submessage SRTPS_PREFIX of
// DDS-Security, with which all of an encrypted datagram begins.
constexpr std::size_t kPrefixAt = 8;
constexpr std::byte kEncrypted{0x33};

}  // namespace

bool is_encrypted(std::span<const std::byte> datagram) {
  return datagram.size() > rtps_wire::kHeaderSize && datagram[rtps_wire::kHeaderSize] == kEncrypted;
}

void PeersHeard::watch(const Prefix& peer, Time now) {
  constexpr int kLongGone = 16;  // chosen: one that is only slow is still counted as silent
  const std::lock_guard lock(mutex_);
  if (!heard_.emplace(peer, now).second) return;
  std::erase_if(heard_, [&](const auto& entry) {
    return now - entry.second > kLongGone * silent_for_;  // said goodbye
  });
}

void PeersHeard::note(std::span<const std::byte> datagram, Time now) {
  if (!is_encrypted(datagram)) return;
  Prefix peer;
  std::memcpy(peer.data(), datagram.data() + kPrefixAt, peer.size());
  const std::lock_guard lock(mutex_);
  if (const auto found = heard_.find(peer); found != heard_.end()) found->second = now;
}

bool PeersHeard::is_silent(const Prefix& peer, Time now) const {
  const std::lock_guard lock(mutex_);
  const auto found = heard_.find(peer);
  return found != heard_.end() && now - found->second > silent_for_;
}

void PeersHeard::part(const Prefix& peer) {
  const std::lock_guard lock(mutex_);
  heard_.erase(peer);
}

}  // namespace mortise
