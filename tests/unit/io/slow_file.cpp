// Takes the place of fdatasync of the C library in this program.
#include "tests/unit/io/slow_file.h"

#include <limits.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace mortise::test {
namespace {

std::mutex mutex;
std::condition_variable changed;
std::string slow_end;  ///< empty: none is slow
bool is_waiting = false;

}  // namespace

SlowFile::SlowFile(const std::string& end_of_name) {
  const std::lock_guard lock(mutex);
  slow_end = end_of_name;
}
SlowFile::~SlowFile() { go_on(); }
bool SlowFile::is_waited_for(double limit_s) const {
  std::unique_lock lock(mutex);
  return changed.wait_for(lock, std::chrono::duration<double>(limit_s), [] { return is_waiting; });
}
void SlowFile::go_on() {
  const std::lock_guard lock(mutex);
  slow_end.clear();
  changed.notify_all();
}

}  // namespace mortise::test

extern "C" int fdatasync(int descriptor) {
  using namespace mortise::test;
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  char target[PATH_MAX] = {};
  const ssize_t size = readlink(link.c_str(), target, sizeof target - 1);
  {
    std::unique_lock lock(mutex);
    const bool is_slow = size > 0 && !slow_end.empty() && std::string(target).ends_with(slow_end);
    if (is_slow) {
      is_waiting = true;
      changed.notify_all();
      changed.wait(lock, [] { return slow_end.empty(); });
      is_waiting = false;
    }
  }
  return static_cast<int>(syscall(SYS_fdatasync, descriptor));
}
