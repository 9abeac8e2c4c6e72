#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/messages/scene.h"

namespace mortise {

/// Says snapshots in a thread of its own: to cut and send one with many decisions takes longer than
/// all else of a tick. Of those that wait the last counts, as on the wire. Thread-safe.
class SnapshotSayer {
 public:
  explicit SnapshotSayer(std::function<void(const Snapshot&)> say);
  /// Waits for nothing.
  void add(Snapshot snapshot);
  /// Returns when the last one is said; none is said after it.
  void stop();

 private:
  void run(const std::stop_token& stopped);

  std::function<void(const Snapshot&)> say_;
  std::mutex mutex_;
  std::condition_variable_any added_;
  std::optional<Snapshot> waiting_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace mortise
