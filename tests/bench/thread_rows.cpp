#include "tests/bench/sections.h"

namespace mortise::bench {

void section_threads(Report&, const Options&) {}

}  // namespace mortise::bench
