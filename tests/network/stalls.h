#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace mortise::test {

/// How long the machine itself stood still (a host that takes processors away, a paused guest): by
/// a thread that does nothing but sleep briefly and look how late it wakes.
class Stalls {
 public:
  Stalls()
      : watch_([this](const std::stop_token& stop) {
          using Clock = std::chrono::steady_clock;
          constexpr std::chrono::duration<double> kNap{0.005};
          for (auto last = Clock::now(); !stop.stop_requested();) {
            std::this_thread::sleep_for(kNap);
            const auto now = Clock::now();
            const std::chrono::duration<double> slept = now - last;
            longest_s_ = std::max(longest_s_.load(), (slept - kNap).count());
            last = now;
          }
        }) {}

  double longest_s() const { return longest_s_; }

 private:
  std::atomic<double> longest_s_{0.0};
  std::jthread watch_;
};

}  // namespace mortise::test
