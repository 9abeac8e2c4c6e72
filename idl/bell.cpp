#include "idl/bell.h"

#include <chrono>

namespace mortise {

void Bell::ring() {
  {
    const std::lock_guard lock(mutex_);
    rung_ = true;
  }
  rings_.notify_one();
}

void Bell::await(std::int64_t at_most_ns) {
  std::unique_lock lock(mutex_);
  rings_.wait_for(lock, std::chrono::nanoseconds(at_most_ns), [this] { return rung_; });
  rung_ = false;
}

}  // namespace mortise
