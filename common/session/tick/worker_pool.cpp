#include "common/session/tick/worker_pool.h"

namespace mortise {
namespace {

// A thread looks so often whether it has something to do before it sleeps, for to be woken takes
// longer than most rounds of a tick. It gives its core to whoever wants it in between.
constexpr int kLooks = 100;

template <class Ready>
void look_for_a_while(const Ready& ready) {
  for (int i = 0; i < kLooks && !ready(); ++i) std::this_thread::yield();
}

}  // namespace

WorkerPool::WorkerPool(int threads) {
  for (int t = 1; t < threads; ++t)
    workers_.emplace_back([this, t](const std::stop_token& stop) { work(stop, t); });
}

WorkerPool::~WorkerPool() {
  for (std::jthread& worker : workers_) worker.request_stop();
  start_.notify_all();
}

void WorkerPool::run(std::size_t count, void* body, Call call) {
  {
    const std::lock_guard lock(mutex_);
    count_ = count;
    body_ = body;
    call_ = call;
    next_.store(0);
    open_ = true;
    ++round_;
  }
  start_.notify_all();
  take_indices(0);
  look_for_a_while([this] { return inside_ == 0; });
  std::unique_lock lock(mutex_);
  open_ = false;  // who comes late finds nothing to do: where other programs have the core, it may
                  // come milliseconds late
  done_.wait(lock, [this] { return inside_ == 0; });
}

void WorkerPool::take_indices(int thread) {
  for (std::size_t i = next_.fetch_add(1); i < count_; i = next_.fetch_add(1))
    call_(body_, i, thread);
}

void WorkerPool::work(const std::stop_token& stop, int thread) {
  std::uint64_t seen = 0;
  while (true) {
    look_for_a_while([&] { return round_ != seen; });
    {
      std::unique_lock lock(mutex_);
      if (!start_.wait(lock, stop, [&] { return open_ && round_ != seen; })) return;
      seen = round_;
      ++inside_;
    }
    take_indices(thread);
    const std::lock_guard lock(mutex_);
    if (--inside_ == 0) done_.notify_one();
  }
}

}  // namespace mortise
