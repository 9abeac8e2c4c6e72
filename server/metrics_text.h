#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "server/backlog.h"
#include "server/tick_loop.h"

namespace mortise {

/// Bounds of the buckets of durations, s: a session of 60 Hz has 16.7 ms for a tick.
inline constexpr std::array<double, 15> kDurationBounds_s = {50e-6,  100e-6, 250e-6, 500e-6, 1e-3,
                                                             2.5e-3, 5e-3,   10e-3,  15e-3,  25e-3,
                                                             50e-3,  0.1,    0.25,   0.5,    1.0};

/// Distribution of durations since the start.
struct DurationFigures {
  std::uint64_t count = 0;
  double sum_s = 0.0;
  std::array<std::uint64_t, kDurationBounds_s.size()> up_to{};  ///< cumulative
};

/// The figures of a running session at one time: plain values, so that another thread may read them
/// while the session continues.
struct SessionFigures {
  std::string session, policy;
  double tick_rate_hz = 0.0, seconds = 0.0;
  std::uint64_t tick = 0, ticks = 0, overloads = 0, missed_deadlines = 0;
  DurationFigures tick_s, step_s, lateness_s, delay_s;
  InboxCounters inbox;
  std::uint64_t users_present = 0, waiting_increments = 0, waiting_commands = 0;
  struct User {
    std::string name;
    bool present = false;
    std::uint64_t parts_held = 0;
    UserCounters counters;
  };
  std::vector<User> users;
  std::array<std::uint64_t, 4> clashes_open{}, clashes_total{};  ///< by CollisionClass
  StepCounters stages;
  ChannelCounters channel;
  Backlog follower;  ///< of the standby
  bool has_log = false, log_failed = false;
  std::uint64_t log_bytes = 0, log_queued_ticks = 0, log_dropped_ticks = 0;
};

/// Taken on the tick thread; costs some microseconds.
SessionFigures figures_of(const TickLoop& loop, const ChannelCounters& channel,
                          const std::string& session, const Backlog& follower = {});

/// The text format of Prometheus, version 0.0.4.
/// `resident_bytes`: memory of the process, 0 when not known.
std::string metrics_text(const SessionFigures& figures, std::uint64_t resident_bytes);

/// Memory of this process that is in use, as the kernel counts it; 0 when it does not say.
std::uint64_t resident_bytes();

}  // namespace mortise
