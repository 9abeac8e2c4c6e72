#pragma once
#include <string>
#include <vector>

namespace mortise::bench {

/// One way to judge, in the picture of time against error.
struct JudgementMark {
  std::string name;
  double time_ms = 0.0;   ///< median
  double error_mm = 0.0;  ///< p99, of the overlap of the true surfaces
  double median_error_mm = 0.0;
  double wrong_percent = 0.0;  ///< words that the truth contradicts
  bool ours = false;
};

/// Draws SVG (and a PNG beside it) with gnuplot, log-log. Says on stderr why when it cannot, and
/// returns false.
bool draw_judgement(const std::vector<JudgementMark>& marks, const std::string& svg_file);

}  // namespace mortise::bench
