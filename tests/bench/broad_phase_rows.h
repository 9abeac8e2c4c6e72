#pragma once
#include "tests/bench/report.h"

namespace mortise::bench {

/// Broad phase and pair filter of one tick beside FCL's dynamic AABB tree on the same boxes.
void broad_phase_rows(Report& report, bool quick);

}  // namespace mortise::bench
