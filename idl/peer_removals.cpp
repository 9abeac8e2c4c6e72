#include "idl/peer_removals.h"

#include <utility>

namespace mortise {

PeerRemovals::PeerRemovals() : thread_([this](const std::stop_token& stopped) { run(stopped); }) {}

void PeerRemovals::add(std::function<void()> removal) {
  {
    const std::lock_guard lock(mutex_);
    due_.push_back(std::move(removal));
  }
  added_.notify_one();
}

void PeerRemovals::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void PeerRemovals::run(const std::stop_token& stopped) {
  while (true) {
    std::vector<std::function<void()>> due;
    {
      std::unique_lock lock(mutex_);
      if (!added_.wait(lock, stopped, [this] { return !due_.empty(); })) return;
      due.swap(due_);
    }
    for (const auto& removal : due) {
      if (stopped.stop_requested()) return;
      removal();
    }
  }
}

}  // namespace mortise
