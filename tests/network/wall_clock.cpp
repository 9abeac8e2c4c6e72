// A library that a test is linked with and that programs are started with (LD_PRELOAD): what it has
// of the C library's functions is found before the C library's own.
#include "tests/network/wall_clock.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>

namespace {

using Seconds = std::atomic<std::int64_t>;
static_assert(Seconds::is_always_lock_free, "it is shared by processes");

constexpr const char* kFile = "MORTISE_TEST_WALL_CLOCK";
std::atomic<Seconds*> shared{nullptr};

Seconds* map_file(const char* file) {
  const int handle = open(file, O_RDWR | O_CLOEXEC);
  if (handle < 0) return nullptr;
  void* place = mmap(nullptr, sizeof(Seconds), PROT_READ | PROT_WRITE, MAP_SHARED, handle, 0);
  close(handle);
  return place == MAP_FAILED ? nullptr : static_cast<Seconds*>(place);
}

std::int64_t ahead_s() {
  Seconds* seconds = shared.load(std::memory_order_acquire);
  if (seconds == nullptr) {
    const char* file = std::getenv(kFile);
    if (file == nullptr || (seconds = map_file(file)) == nullptr) return 0;
    shared.store(seconds, std::memory_order_release);
  }
  return seconds->load(std::memory_order_relaxed);
}

timespec machine_s(clockid_t clock) {
  timespec now{};
  syscall(SYS_clock_gettime, clock, &now);
  return now;
}

/// A time of the stepped clock as the kernel waits for it.
timespec as_machine_s(timespec deadline) {
  deadline.tv_sec -= ahead_s();
  return deadline;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const int failed = static_cast<int>(syscall(SYS_clock_gettime, clock, now));
  if (failed == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
    now->tv_sec += ahead_s();
  return failed;
}

int gettimeofday(timeval* now, void*) noexcept {
  timespec at{};
  clock_gettime(CLOCK_REALTIME, &at);
  now->tv_sec = at.tv_sec;
  now->tv_usec = at.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* now) noexcept {
  timespec at{};
  clock_gettime(CLOCK_REALTIME, &at);
  if (now != nullptr) *now = at.tv_sec;
  return at.tv_sec;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* deadline) {
  static auto* const wait = next<decltype(pthread_cond_timedwait)>("pthread_cond_timedwait");
  // By which clock, the condition alone knows: the one that is nearer.
  const std::int64_t wall_s = machine_s(CLOCK_REALTIME).tv_sec + ahead_s();
  const bool is_wall = std::abs(deadline->tv_sec - wall_s) <
                       std::abs(deadline->tv_sec - machine_s(CLOCK_MONOTONIC).tv_sec);
  const timespec machine_deadline = is_wall ? as_machine_s(*deadline) : *deadline;
  return wait(condition, mutex, &machine_deadline);
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* deadline) {
  static auto* const wait = next<decltype(pthread_cond_clockwait)>("pthread_cond_clockwait");
  const timespec machine_deadline = clock == CLOCK_REALTIME ? as_machine_s(*deadline) : *deadline;
  return wait(condition, mutex, clock, &machine_deadline);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* deadline) noexcept {
  static auto* const lock = next<decltype(pthread_mutex_timedlock)>("pthread_mutex_timedlock");
  const timespec machine_deadline = as_machine_s(*deadline);
  return lock(mutex, &machine_deadline);
}

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                            const timespec* deadline) noexcept {
  static auto* const lock = next<decltype(pthread_mutex_clocklock)>("pthread_mutex_clocklock");
  const timespec machine_deadline = clock == CLOCK_REALTIME ? as_machine_s(*deadline) : *deadline;
  return lock(mutex, clock, &machine_deadline);
}

int sem_timedwait(sem_t* semaphore, const timespec* deadline) {
  static auto* const wait = next<decltype(sem_timedwait)>("sem_timedwait");
  const timespec machine_deadline = as_machine_s(*deadline);
  return wait(semaphore, &machine_deadline);
}

}  // extern "C"

namespace mortise::test {

WallClock::WallClock(const std::filesystem::path& folder) {
  const std::string file = (folder / "wall_clock").string();
  const int handle = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (handle < 0 || ftruncate(handle, sizeof(Seconds)) != 0) std::abort();
  close(handle);
  ahead_s_ = map_file(file.c_str());
  if (ahead_s_ == nullptr) std::abort();
  setenv(kFile, file.c_str(), 1);
  Dl_info own{};
  dladdr(reinterpret_cast<const void*>(&map_file), &own);
  setenv("LD_PRELOAD", own.dli_fname, 1);
}

WallClock::~WallClock() {
  unsetenv("LD_PRELOAD");
  unsetenv(kFile);
  ahead_s_->store(0);  // for this process, which may still look there
}

void WallClock::step(std::int64_t seconds) { ahead_s_->fetch_add(seconds); }

}  // namespace mortise::test
