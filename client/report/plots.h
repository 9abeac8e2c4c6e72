#pragma once
#include <string>

#include "client/report/report.h"

namespace mortise {

/// How deep each clash was while it lasted, over the time of the session and against its
/// thresholds, as the events tell it. Nothing without clashes.
std::string depth_section(const SessionReport& report);

/// What the engine took for ticks, second by second, against the time that one may take. Nothing
/// where the log has no times.
std::string tick_time_section(const SessionReport& report);

}  // namespace mortise
