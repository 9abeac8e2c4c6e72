#pragma once
#include <cstdint>
#include <limits>
#include <string>

#include "common/base/ids.h"
#include "common/base/result.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

/// Which picture of a log: the clash as it was judged last, up to a tick.
struct ClashMoment {
  ClashId clash;
  std::uint64_t until_tick = std::numeric_limits<std::uint64_t>::max();
};

/// The section of `judge --picture` through one clash of a log, as SVG. kNotFound: the log does not
/// judge this clash up to that tick. Costs loading the scene and one pass.
Result<std::string> clash_picture(const SessionLog& log, const ClashMoment& wanted);

}  // namespace mortise
