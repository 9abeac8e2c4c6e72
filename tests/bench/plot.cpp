#include "tests/bench/plot.h"

namespace mortise::bench {
bool draw_time_against_error(const std::vector<Mark>&, const std::string&) { return false; }
}  // namespace mortise::bench
