#pragma once
#include <string>
#include <vector>

namespace mortise::bench {

/// One method in the picture of time against error.
struct Mark {
  std::string name;
  double time_ms = 0.0;
  double error_mm = 0.0;  ///< p99 of early and late
  double median_error_mm = 0.0;
  bool late = false;  ///< some contacts were found after they happened, or missed
  long long missed = 0, contacts = 0;
  bool ours = false;
};

/// Draws SVG (and a PNG beside it) with gnuplot: log-log, the Pareto front marked. Says on stderr
/// why when it cannot, and returns false.
bool draw_time_against_error(const std::vector<Mark>& marks, const std::string& svg_file);

}  // namespace mortise::bench
