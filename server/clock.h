#pragma once
#include <cstdint>

namespace mortise {

/// The clock of the server; tests replace it.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() = 0;   ///< never goes back
  virtual std::int64_t wall_ns() = 0;  ///< since 1970, for the log's timeline only
  /// Sleeps until now_ns() would say `deadline_ns`; returns at once when that is past.
  virtual void sleep_until_ns(std::int64_t deadline_ns) = 0;
};

/// CLOCK_MONOTONIC with absolute deadlines, so that a late tick does not make the next ones late.
/// wall_ns() never goes back and is never before `not_before_ns`: when the machine's clock is set
/// back, it continues from its last value until the machine's clock has caught up.
class SystemClock : public Clock {
 public:
  explicit SystemClock(std::int64_t not_before_ns = 0);
  std::int64_t now_ns() override;
  std::int64_t wall_ns() override;
  void sleep_until_ns(std::int64_t deadline_ns) override;
  double ahead_s();  ///< of the machine's clock; mostly 0

 private:
  std::int64_t wall_ns_, asked_at_ns_;  ///< what it said last, and when
};

}  // namespace mortise
