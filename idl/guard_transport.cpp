#include "idl/guard_transport.h"

#include <fastdds/rtps/transport/TransportReceiverInterface.h>

#include <span>
#include <vector>

#include "common/base/hash.h"
#include "idl/datagram_guard.h"

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// Knows the encrypted datagrams that came last. Each has a random number of its own, so that one
/// that comes again is from a recording, or was doubled on the way.
class LastDatagrams {
 public:
  bool has(std::span<const std::byte> datagram) {
    if (!is_encrypted(datagram)) return false;
    StateHash hash;
    hash.add(datagram);
    return places_[hash.value() % kPlaces].exchange(hash.value(), std::memory_order_relaxed) ==
           hash.value();
  }

 private:
  static constexpr std::size_t kPlaces = 1 << 16;  // some 10 s of a session of 64 at 60 Hz
  std::vector<std::atomic<std::uint64_t>> places_ =
      std::vector<std::atomic<std::uint64_t>>(kPlaces);
};

class GuardTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit GuardTransport(const GuardDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {
    if (descriptor.repeats) last_ = std::make_unique<LastDatagrams>();
  }

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
    const auto datagram = std::as_bytes(std::span(buffer, size));
    const bool is_repeat = last_ && last_->has(datagram);
    if (is_repeat) descriptor_.counts->repeated.fetch_add(1, std::memory_order_relaxed);
    if (descriptor_.peers && !is_repeat) descriptor_.peers->note(datagram);
    const std::size_t length = is_repeat ? 0 : admissible_length(datagram);
    // Fast DDS hangs statistics on what it sends; that they are cut off is no sign of trouble.
    if (length == 0) descriptor_.counts->dropped.fetch_add(1, std::memory_order_relaxed);
    if (0 < length && length < size)
      descriptor_.counts->cut.fetch_add(1, std::memory_order_relaxed);
    if (length > 0) next->OnDataReceived(buffer, static_cast<std::uint32_t>(length), local, remote);
  }

 private:
  GuardDescriptor descriptor_;
  std::unique_ptr<LastDatagrams> last_;  ///< null: repeats are let through
};

}  // namespace

eprosima::fastdds::rtps::TransportInterface* GuardDescriptor::create_transport() const {
  return new GuardTransport(*this);  // Fast DDS takes ownership
}

}  // namespace mortise
