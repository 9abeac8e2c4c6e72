#pragma once
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/wait.h>

namespace mortise::test {

/// Stops one thread of another process, and lets it go with the object; all its other threads go
/// on. All of it in one thread of the test.
class StoppedThread {
 public:
  explicit StoppedThread(pid_t thread) : thread_(thread) {
    int status = 0;
    held_ = ptrace(PTRACE_SEIZE, thread_, 0, 0) == 0 &&
            ptrace(PTRACE_INTERRUPT, thread_, 0, 0) == 0 &&
            waitpid(thread_, &status, __WALL) == thread_;
  }
  ~StoppedThread() { release(); }
  StoppedThread(const StoppedThread&) = delete;
  StoppedThread& operator=(const StoppedThread&) = delete;

  bool held() const { return held_; }
  void release() {
    if (held_) ptrace(PTRACE_DETACH, thread_, 0, 0);
    held_ = false;
  }

 private:
  pid_t thread_;
  bool held_ = false;
};

}  // namespace mortise::test
