#pragma once
#include <atomic>
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

/// A reader that rings a bell, and knows whether a sample has come since it was last asked: most
/// looks at most readers would find nothing.
struct Inlet final : dds::DataReaderListener {
  explicit Inlet(Bell& rings) : bell(rings) {}
  /// A sample that comes meanwhile is told at the next call.
  bool take_come() { return come.exchange(false, std::memory_order_acquire); }
  void on_data_available(dds::DataReader*) override {
    come.store(true, std::memory_order_release);
    bell.ring();
  }

  Bell& bell;
  dds::DataReader* reader = nullptr;
  std::atomic<bool> come{false};
};

}  // namespace mortise
