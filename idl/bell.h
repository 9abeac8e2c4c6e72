#pragma once
#include <condition_variable>
#include <cstdint>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <mutex>

namespace mortise {

namespace dds = eprosima::fastdds::dds;

/// Rung by a thread of Fast DDS.
class Bell {
 public:
  void ring();
  /// Returns when it has rung since the last call, or after so long.
  void await(std::int64_t at_most_ns);

 private:
  std::mutex mutex_;
  std::condition_variable rings_;
  bool rung_ = false;
};

/// Rings when a sample comes.
class SampleBell final : public dds::DataReaderListener {
 public:
  void ring() { bell_.ring(); }
  void await(std::int64_t at_most_ns) { bell_.await(at_most_ns); }
  void on_data_available(dds::DataReader*) override { ring(); }

 private:
  Bell bell_;
};

}  // namespace mortise
