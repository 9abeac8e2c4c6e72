#pragma once
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace mortise::bench {

/// Keeps every core awake with work that anything else runs before (SCHED_IDLE). A core that sleeps
/// between two ticks begins each of them cold and slow, the more so the less others do: ten idle
/// minutes doubled the CPU time of a tick, and what came beside it looked like a gain.
class Awake {
 public:
  Awake() {
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
      spinners_.emplace_back([](const std::stop_token& stop) {
        const sched_param least{};
        if (pthread_setschedparam(pthread_self(), SCHED_IDLE, &least) != 0) return;
        while (!stop.stop_requested()) {
        }
      });
    }
  }

 private:
  std::vector<std::jthread> spinners_;
};

}  // namespace mortise::bench
