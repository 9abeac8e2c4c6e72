#include "tests/bench/sections.h"

namespace mortise::bench {

void section_tick(Report&, const Options&) {}

}  // namespace mortise::bench
