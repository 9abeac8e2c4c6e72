#include "idl/peers_heard.h"

#include <cstring>

#include "idl/rtps_bytes.h"

namespace mortise {
namespace {

constexpr std::size_t kPrefixAt = 8;
constexpr std::byte kEncrypted{0x33};

}  // namespace

bool is_encrypted(std::span<const std::byte> datagram) {
  return datagram.size() > rtps_wire::kHeaderSize && datagram[rtps_wire::kHeaderSize] == kEncrypted;
}

void PeersHeard::watch(const Prefix& peer, Time now) {
  const std::lock_guard lock(mutex_);
  heard_.emplace(peer, now);
}

void PeersHeard::note(std::span<const std::byte> datagram, Time now) {
  if (!is_encrypted(datagram)) return;
  Prefix peer;
  std::memcpy(peer.data(), datagram.data() + kPrefixAt, peer.size());
  const std::lock_guard lock(mutex_);
  if (const auto found = heard_.find(peer); found != heard_.end()) found->second = now;
}

std::vector<PeersHeard::Prefix> PeersHeard::take_silent(Time now) {
  std::vector<Prefix> silent;
  const std::lock_guard lock(mutex_);
  std::erase_if(heard_, [&](const auto& entry) {
    const bool is_silent = now - entry.second > silent_for_;
    if (is_silent) silent.push_back(entry.first);
    return is_silent;
  });
  return silent;
}

}  // namespace mortise
