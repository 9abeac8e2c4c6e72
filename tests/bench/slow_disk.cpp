// Takes the place of write and fdatasync of the C library in this program, so that the recorder
// itself is measured as it is, on a disk that waits.
#include <limits.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>

#include "tests/bench/records_sections.h"

namespace mortise::bench {
namespace {

std::mutex mutex;
std::string slow_file;
SlowDisk slow_disk;
std::atomic<bool> any{false};
std::atomic<long long> writes{0}, syncs{0};

double wait_of(int descriptor, bool sync) {
  if (!any) return 0.0;
  char link[64], target[PATH_MAX] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  if (readlink(link, target, sizeof target - 1) <= 0) return 0.0;
  const std::lock_guard lock(mutex);
  if (slow_file != target) return 0.0;
  ++(sync ? syncs : writes);
  return sync ? slow_disk.sync_s : slow_disk.write_s;
}

void wait(double s) {
  if (s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(s));
}

}  // namespace

void make_slow(const std::filesystem::path& file, const SlowDisk& disk) {
  const std::lock_guard lock(mutex);
  slow_file = file.string();
  slow_disk = disk;
  any = !slow_file.empty();
}

SlowCalls slow_calls() { return {writes, syncs}; }

}  // namespace mortise::bench

extern "C" ssize_t write(int descriptor, const void* bytes, size_t count) {
  mortise::bench::wait(mortise::bench::wait_of(descriptor, false));
  return syscall(SYS_write, descriptor, bytes, count);
}
extern "C" int fdatasync(int descriptor) {
  mortise::bench::wait(mortise::bench::wait_of(descriptor, true));
  return static_cast<int>(syscall(SYS_fdatasync, descriptor));
}
extern "C" int fsync(int descriptor) {
  mortise::bench::wait(mortise::bench::wait_of(descriptor, true));
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}
