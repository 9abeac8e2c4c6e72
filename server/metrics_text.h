#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "server/backlog.h"
#include "server/tick_loop.h"

namespace mortise {

/// Summary of a distribution of durations, s.
struct DurationFigures {
  std::uint64_t count = 0;
  double p50_s = 0.0, p90_s = 0.0, p99_s = 0.0, max_s = 0.0;
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
