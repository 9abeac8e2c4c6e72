#include "idl/snapshot_sayer.h"

#include <utility>

namespace mortise {

SnapshotSayer::SnapshotSayer(std::function<void(const Snapshot&)> say)
    : say_(std::move(say)), thread_([this](const std::stop_token& stopped) { run(stopped); }) {}

void SnapshotSayer::add(Snapshot snapshot) {
  std::optional<Snapshot> passed_over(std::move(snapshot));
  {
    const std::lock_guard lock(mutex_);
    waiting_.swap(passed_over);
  }
  added_.notify_one();
}

void SnapshotSayer::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void SnapshotSayer::run(const std::stop_token& stopped) {
  while (true) {
    std::optional<Snapshot> next;
    {
      std::unique_lock lock(mutex_);
      if (!added_.wait(lock, stopped, [this] { return waiting_.has_value(); })) return;
      next.swap(waiting_);
    }
    say_(*next);
  }
}

}  // namespace mortise
