#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace mortise {

/// Removes peers whose lease has ended, in a thread of its own. Fast DDS 2.9.1 does it in the
/// thread of its timers, and stands still for good where a datagram of another one that leaves is
/// taken at that moment: who takes it has the lock of the security manager, and waits until the
/// timers rest; the timer waits for the lock. Thread-safe.
class PeerRemovals {
 public:
  PeerRemovals();
  /// In turn. Not carried out after stop().
  void add(std::function<void()> removal);
  /// Waits for what is under way.
  void stop();
  bool stops() const { return thread_.get_stop_token().stop_requested(); }

 private:
  void run(const std::stop_token& stopped);

  std::mutex mutex_;
  std::condition_variable_any added_;
  std::vector<std::function<void()>> due_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace mortise
