#pragma once
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>

namespace mortise {

/// A generated type whose reading of strangers' bytes never throws: the generated code lets all but
/// one exception out into Fast DDS's receive thread, which ends the process. Refused samples are
/// counted. A sample of a program of before lacks the members that were appended since: they read
/// as zero, as no text and as no entries.
template <class Generated>
class SafeType final : public Generated {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

  explicit SafeType(std::shared_ptr<std::atomic<std::uint64_t>> refused)
      : refused_(std::move(refused)) {}

  bool deserialize(Payload* payload, void* data) override {
    if (reads(payload, data) || reads_of_before(*payload, data)) return true;
    refused_->fetch_add(1, std::memory_order_relaxed);
    return false;
  }

  bool getKey(void* data, Handle* handle, bool force_md5) override {
    try {
      return Generated::getKey(data, handle, force_md5);
    } catch (...) {
      refused_->fetch_add(1, std::memory_order_relaxed);
      return false;
    }
  }

 private:
  /// What all members are long, empty, that were appended to one type since 0.2.0, at most.
  static constexpr std::uint32_t kAppended_bytes = 32;

  bool reads(Payload* payload, void* data) {
    try {
      return Generated::deserialize(payload, data);
    } catch (...) {  // whatever it is, it must not leave this thread
      return false;
    }
  }
  bool reads_of_before(const Payload& payload, void* data) {
    if (payload.length < Payload::representation_header_size) return false;
    Payload longer(payload.length + kAppended_bytes);
    std::memcpy(longer.data, payload.data, payload.length);
    std::memset(longer.data + payload.length, 0, kAppended_bytes);
    longer.length = longer.max_size;
    return reads(&longer, data);
  }

  std::shared_ptr<std::atomic<std::uint64_t>> refused_;
};

}  // namespace mortise
