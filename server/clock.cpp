#include "server/clock.h"

#include <time.h>

#include <algorithm>

namespace mortise {
namespace {

std::int64_t read_ns(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

SystemClock::SystemClock(std::int64_t not_before_ns)
    : wall_ns_(not_before_ns), asked_at_ns_(read_ns(CLOCK_MONOTONIC)) {}

std::int64_t SystemClock::now_ns() { return read_ns(CLOCK_MONOTONIC); }

std::int64_t SystemClock::wall_ns() {
  const std::int64_t now_ns = read_ns(CLOCK_MONOTONIC);
  wall_ns_ = std::max(read_ns(CLOCK_REALTIME), wall_ns_ + (now_ns - asked_at_ns_));
  asked_at_ns_ = now_ns;
  return wall_ns_;
}

double SystemClock::ahead_s() {
  return static_cast<double>(wall_ns() - read_ns(CLOCK_REALTIME)) * 1e-9;
}

void SystemClock::sleep_until_ns(std::int64_t deadline_ns) {
  timespec deadline{};
  deadline.tv_sec = deadline_ns / 1'000'000'000;
  deadline.tv_nsec = deadline_ns % 1'000'000'000;
  // Interrupted by a signal: the caller looks at its stop flag, so one attempt is right.
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace mortise
