#pragma once
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

namespace mortise {

/// A generated type whose reading of strangers' bytes never throws: the generated code lets all but
/// one exception out into Fast DDS's receive thread, which ends the process. Refused samples are
/// counted.
template <class Generated>
class SafeType final : public Generated {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

  explicit SafeType(std::shared_ptr<std::atomic<std::uint64_t>> refused)
      : refused_(std::move(refused)) {}

  bool deserialize(Payload* payload, void* data) override {
    try {
      if (Generated::deserialize(payload, data)) return true;
    } catch (...) {  // whatever it is, it must not leave this thread
    }
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
  std::shared_ptr<std::atomic<std::uint64_t>> refused_;
};

}  // namespace mortise
