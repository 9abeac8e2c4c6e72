#pragma once
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <atomic>
#include <cstdint>
#include <memory>

namespace mortise {

using DropCounter = std::shared_ptr<std::atomic<std::uint64_t>>;

/// A transport that hands on only datagrams that datagram_guard admits, and counts the others.
struct GuardDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  GuardDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> inner,
                  DropCounter dropped_counter)
      : ChainingTransportDescriptor(std::move(inner)), dropped(std::move(dropped_counter)) {}
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  DropCounter dropped;
};

}  // namespace mortise
