#pragma once
#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

namespace mortise::test {

/// How long the machine itself stood still (a host that takes processors away, a paused guest): by
/// a thread that does nothing but sleep briefly and look how late it wakes.
class Stalls {
 public:
  Stalls()
      : watch_([this](const std::stop_token& stop) {
          for (auto last = Clock::now(); !stop.stop_requested();) {
            std::this_thread::sleep_for(kNap);
            const auto now = Clock::now();
            const Seconds late = now - last - kNap;
            if (late > kNap) {
              const std::lock_guard<std::mutex> lock(mutex_);
              stalls_.push_back({last - begun_, late});
            }
            last = now;
          }
        }) {}

  /// Of those that came within so long after this one was made.
  double longest_s(double within_s) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    double longest_s = 0.0;
    for (const Stall& stall : stalls_)
      if (stall.at.count() <= within_s) longest_s = std::max(longest_s, stall.length.count());
    return longest_s;
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  static constexpr Seconds kNap{0.005};
  struct Stall {
    Seconds at, length;
  };

  const Clock::time_point begun_ = Clock::now();
  mutable std::mutex mutex_;
  std::vector<Stall> stalls_;
  std::jthread watch_;  // the last member: it ends before the others do
};

}  // namespace mortise::test
