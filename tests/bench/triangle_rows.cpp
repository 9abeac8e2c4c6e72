#include "tests/bench/sections.h"

namespace mortise::bench {

void section_triangles(Report&, const Options&) {}

}  // namespace mortise::bench
