#pragma once
#include <string>
#include <vector>

#include "common/io/report_json.h"
#include "server/tick_loop.h"

namespace mortise {

/// What is said at the end of a session.
struct Closing {
  std::string session, scenario, policy;
  std::string log_file;  ///< empty: none was written
  std::uint64_t log_bytes = 0, log_dropped_ticks = 0;
  std::vector<std::string> parts_without_inside;
  ChannelCounters channel;
};

Json closing_json(const Closing& closing, const TickLoop& loop);

/// The same as tables.
std::string closing_table(const Closing& closing, const TickLoop& loop);

}  // namespace mortise
