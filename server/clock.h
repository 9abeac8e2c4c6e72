#pragma once
#include <cstdint>

namespace mortise {

/// The time as the server sees it; tests put their own in its place.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() = 0;   ///< never goes back
  virtual std::int64_t wall_ns() = 0;  ///< since 1970, for the log's timeline only
  /// Sleeps until now_ns() would say `deadline_ns`; returns at once when that is past.
  virtual void sleep_until_ns(std::int64_t deadline_ns) = 0;
};

/// CLOCK_MONOTONIC with absolute deadlines, so that a late tick does not make the next ones late.
class SystemClock : public Clock {
 public:
  std::int64_t now_ns() override;
  std::int64_t wall_ns() override;
  void sleep_until_ns(std::int64_t deadline_ns) override;
};

}  // namespace mortise
