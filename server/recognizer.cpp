#include "server/recognizer.h"

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "common/geometry/recognition/recognized.h"

namespace mortise {

struct Recognizer::Work {
  std::vector<SolidPtr> meshes;
  std::mutex mutex;
  std::vector<Shown> found;
  std::atomic<bool> stop{false}, done{false};

  void run() {
    for (const SolidPtr& mesh : meshes) {
      if (stop) return;
      const auto shown = recognized(*mesh);
      const std::lock_guard lock(mutex);
      found.push_back({mesh->hash(), {shown, &shown->features}});
    }
    done = true;
  }
};

Recognizer::Recognizer(std::vector<SolidPtr> meshes) : work_(std::make_shared<Work>()) {
  work_->meshes = std::move(meshes);
  std::thread thread([work = work_] { work->run(); });
  const sched_param idle{};
  // Where it is not permitted the thread runs as any other.
  (void)pthread_setschedparam(thread.native_handle(), SCHED_IDLE, &idle);
  // On a busy machine it may be long until such a thread gets to its end: nobody waits for it.
  thread.detach();
}

Recognizer::~Recognizer() { work_->stop = true; }

std::vector<Recognizer::Shown> Recognizer::take() {
  const std::lock_guard lock(work_->mutex);
  return std::exchange(work_->found, {});
}

bool Recognizer::done() const { return work_->done; }

}  // namespace mortise
