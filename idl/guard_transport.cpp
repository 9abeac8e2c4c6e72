#include "idl/guard_transport.h"

#include <fastdds/rtps/transport/TransportReceiverInterface.h>

#include "idl/datagram_guard.h"

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

class GuardTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit GuardTransport(const GuardDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return &descriptor_;
  }

  bool send(rtps::SenderResource* sender, const rtps::octet* buffer, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return sender->send(buffer, size, begin, end, timeout);
  }

  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next, const rtps::octet* buffer,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const std::size_t length = admissible_length(std::as_bytes(std::span(buffer, size)));
    // Fast DDS hangs statistics on what it sends; that they are cut off is no sign of trouble.
    if (length == 0) descriptor_.counts->dropped.fetch_add(1, std::memory_order_relaxed);
    if (0 < length && length < size)
      descriptor_.counts->cut.fetch_add(1, std::memory_order_relaxed);
    if (length > 0) next->OnDataReceived(buffer, static_cast<std::uint32_t>(length), local, remote);
  }

 private:
  GuardDescriptor descriptor_;
};

}  // namespace

eprosima::fastdds::rtps::TransportInterface* GuardDescriptor::create_transport() const {
  return new GuardTransport(*this);  // Fast DDS takes ownership
}

}  // namespace mortise
