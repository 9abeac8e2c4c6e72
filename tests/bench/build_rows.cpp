#include "tests/bench/sections.h"

namespace mortise::bench {

void section_build(Report&, const Options&) {}

}  // namespace mortise::bench
