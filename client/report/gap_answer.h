#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"
#include "common/base/result.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

/// Two parts of a log as they stand after a tick, or at its end.
struct GapMoment {
  PartId a, b;
  std::uint64_t tick = 0;
};

/// Their gap as JSON: `a`, `b`, `tick`, `mesh_mm`, `real_mm` [lo, hi] (see pair_gap), `verdict`: is
/// it that of a verdict? Poses of moved parts are those of the log, and the interval is wider by
/// what these are rounded. kNotFound: there is no such part then. Costs loading the scene, one
/// pass, and the overlaps of pair_gap.
Result<std::string> gap_answer(const SessionLog& log, const GapMoment& wanted);

}  // namespace mortise
