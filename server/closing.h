#pragma once
#include <string>
#include <vector>

#include "common/io/report_json.h"
#include "server/backlog.h"
#include "server/tick_loop.h"

namespace mortise {

/// The closing report of a session.
struct Closing {
  std::string session, scenario, policy;
  std::string log_file;  ///< empty: none was written
  std::uint64_t log_bytes = 0, log_dropped_ticks = 0;
  std::string log_error;      ///< error of the disk; empty: none
  std::string restored_from;  ///< the earlier log; empty: the scenario began anew
  std::uint64_t restored_ticks = 0, restore_left_out_ticks = 0;
  std::vector<std::string> parts_without_inside;
  ChannelCounters channel;
  Backlog follower;  ///< of the server that stood by, if any
};

Json closing_json(const Closing& closing, const TickLoop& loop);

/// The same as tables.
std::string closing_table(const Closing& closing, const TickLoop& loop);

}  // namespace mortise
