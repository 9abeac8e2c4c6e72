#include "tests/bench/sections.h"

namespace mortise::bench {

void section_distance(Report&, const Options&) {}

}  // namespace mortise::bench
