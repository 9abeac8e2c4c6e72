#include "server/clock.h"

#include <time.h>

namespace mortise {
namespace {

std::int64_t read_ns(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

std::int64_t SystemClock::now_ns() { return read_ns(CLOCK_MONOTONIC); }
std::int64_t SystemClock::wall_ns() { return read_ns(CLOCK_REALTIME); }

void SystemClock::sleep_until_ns(std::int64_t deadline_ns) {
  timespec deadline{};
  deadline.tv_sec = deadline_ns / 1'000'000'000;
  deadline.tv_nsec = deadline_ns % 1'000'000'000;
  // Interrupted by a signal: the caller looks at its stop flag, so one attempt is right.
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace mortise
