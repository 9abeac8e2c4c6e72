#pragma once
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <atomic>
#include <cstdint>
#include <memory>

#include "idl/peers_heard.h"

namespace mortise {

/// Datagrams, by what became of them; written by threads of Fast DDS.
struct GuardCounts {
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<std::uint64_t> repeated{0};  ///< of these: encrypted ones that came before
  std::atomic<std::uint64_t> cut{0};  ///< of the statistics that Fast DDS hangs on its datagrams
};

/// A transport that hands on only datagrams that datagram_guard admits, and counts the others.
struct GuardDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  GuardDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> inner,
                  std::shared_ptr<GuardCounts> guard_counts, bool looks_for_repeats,
                  std::shared_ptr<PeersHeard> peers_heard)
      : ChainingTransportDescriptor(std::move(inner)),
        counts(std::move(guard_counts)),
        peers(std::move(peers_heard)),
        repeats(looks_for_repeats) {}
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  std::shared_ptr<GuardCounts> counts;
  std::shared_ptr<PeersHeard> peers;  ///< null: no security
  bool repeats;                       ///< drop encrypted datagrams that came before: takes 0.5 MB
};

}  // namespace mortise
