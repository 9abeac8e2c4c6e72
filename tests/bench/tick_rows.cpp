#include "tests/bench/broad_phase_rows.h"
#include "tests/bench/sections.h"

namespace mortise::bench {

void section_tick(Report& report, const Options& options) {
  broad_phase_rows(report, options.quick);
}

}  // namespace mortise::bench
