#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <span>

namespace mortise {

/// When encrypted datagrams of some participants came last. Whoever stood still for longer than its
/// lease is forgotten by the others, and remembers them: they prove their identity anew, and are
/// not answered, since they have proven it (Fast DDS 2.9.1). Only what is not encrypted passes
/// between the two from then on. So one that spoke, and now says nothing encrypted for long, is
/// forgotten as well: then both begin anew. Thread-safe.
class PeersHeard {
 public:
  using Prefix = std::array<std::byte, 12>;  ///< of the GUID
  using Time = std::chrono::steady_clock::time_point;

  explicit PeersHeard(std::chrono::duration<double> silent_for)
      : silent_for_(std::chrono::duration_cast<Time::duration>(silent_for)) {}

  /// It has said something that counts, and will again as long as it knows us.
  void watch(const Prefix& peer, Time now = Time::clock::now());
  /// Any datagram that came.
  void note(std::span<const std::byte> datagram, Time now = Time::clock::now());
  /// Is watched, and has been silent for so long.
  bool is_silent(const Prefix& peer, Time now = Time::clock::now()) const;
  /// It is gone, or forgotten: not watched until it says something again.
  void part(const Prefix& peer);

 private:
  const Time::duration silent_for_;
  mutable std::mutex mutex_;
  std::map<Prefix, Time> heard_;
};

/// Does it begin with the prefix of encrypted submessages (SRTPS_PREFIX)?
bool is_encrypted(std::span<const std::byte> datagram);

}  // namespace mortise
