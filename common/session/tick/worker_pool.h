#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace mortise {

/// A few threads that share the indices of one loop. Any thread may take any index, so a loop body
/// may write only data of its index. Results are then merged in the order of indices and do not
/// depend on the number of threads.
class WorkerPool {
 public:
  /// `threads` >= 1 in all, the caller's own included.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls body(index, thread) for every index in [0, count), thread in [0, threads()); returns
  /// when all are done. A worker that has not begun by then is not waited for. No allocation. body
  /// must not throw.
  template <class Body>
  void for_each(std::size_t count, Body&& body) {
    if (workers_.empty() || count < 2) {
      for (std::size_t i = 0; i < count; ++i) body(i, 0);
      return;
    }
    using Plain = std::remove_reference_t<Body>;
    run(count, &body, [](void* self, std::size_t i, int t) { (*static_cast<Plain*>(self))(i, t); });
  }

 private:
  using Call = void (*)(void* body, std::size_t index, int thread);
  void run(std::size_t count, void* body, Call call);
  void take_indices(int thread);
  void work(const std::stop_token& stop, int thread);

  std::mutex mutex_;
  std::condition_variable_any start_;
  std::condition_variable done_;
  std::atomic<std::uint64_t> round_ = 0;  // written under mutex_
  bool open_ = false;            // guarded by mutex_: indices of the round are left to take
  std::atomic<int> inside_ = 0;  // written under mutex_: workers that take indices of the round
  std::size_t count_ = 0;
  void* body_ = nullptr;
  Call call_ = nullptr;
  std::atomic<std::size_t> next_ = 0;
  std::vector<std::jthread> workers_;  // last: joins before the rest goes
};

}  // namespace mortise
