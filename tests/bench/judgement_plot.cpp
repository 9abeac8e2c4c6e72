#include "tests/bench/judgement_plot.h"

#include <algorithm>
#include <cmath>

#include "tests/bench/gnuplot.h"
#include "tests/bench/plot_labels.h"

namespace mortise::bench {
namespace {

constexpr double kLeastError_mm = 1e-8;

TimeErrorAxes axes_of(const std::vector<JudgementMark>& marks) {
  TimeErrorAxes axes{1e9, 0.0, kLeastError_mm, 1e-2};
  for (const JudgementMark& mark : marks) {
    axes.least_ms = std::min(axes.least_ms, mark.time_ms);
    axes.most_ms = std::max(axes.most_ms, mark.time_ms);
    axes.most_mm = std::max(axes.most_mm, mark.error_mm);
  }
  // Half a decade below, one above for the key, one to the right for the words.
  return {std::pow(10.0, std::floor(std::log10(0.5 * axes.least_ms))),
          std::pow(10.0, std::ceil(std::log10(4.0 * axes.most_ms))), kLeastError_mm,
          std::pow(10.0, std::ceil(std::log10(4.0 * axes.most_mm)))};
}

std::string block(const char* name, const std::vector<JudgementMark>& marks, bool ours) {
  std::string text = "$";
  text.append(name).append(" << EOD\n");
  for (const JudgementMark& mark : marks)
    if (mark.ours == ours)
      text += format("%.6g %.6g %.6g\n", std::max(kLeastError_mm, mark.error_mm),
                     std::max(kLeastError_mm, mark.median_error_mm), mark.time_ms);
  return text + "EOD\n";
}

std::string labels_of(const std::vector<JudgementMark>& marks, const TimeErrorAxes& axes) {
  LabelPlaces places(axes.width(), axes.height());
  places.take({0, axes.height() - 60, 420, axes.height()});  // the key
  for (const JudgementMark& mark : marks) {
    const double x = axes.x(mark.error_mm), y = axes.y(mark.time_ms);
    places.take({x - 7, y - 7, x + 7, y + 7});
    places.take({axes.x(mark.median_error_mm), y - 2, x, y + 2});
  }
  std::string text;
  for (const JudgementMark& mark : marks) {
    const std::string words = mark.name + format(": %.3g %% wrong", mark.wrong_percent);
    const Placed at = places.place(axes.x(mark.error_mm), axes.y(mark.time_ms), words);
    text += "set label " + quoted_for_gnuplot(words) +
            format(" at graph %.4f,%.4f ", at.x / axes.width(), at.y / axes.height()) +
            (at.to_the_left ? "right" : "left") + " font ',11' tc rgb '" +
            (mark.ours ? "#38761d" : "#cc4125") + "'\n";
  }
  return text;
}

}  // namespace

bool draw_judgement(const std::vector<JudgementMark>& marks, const std::string& svg_file) {
  if (marks.empty()) return false;
  const TimeErrorAxes axes = axes_of(marks);
  return draw_picture(
      axes,
      {"error of the overlap of the true surfaces, mm (mark: p99, whisker: from the median)",
       "CPU time of a pair, ms (median, one thread)"},
      block("ours", marks, true) + block("peers", marks, false) + labels_of(marks, axes),
      R"(plot $ours using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#b6d7a8' notitle, \
  $peers using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#f4b6a0' notitle, \
  $ours using 1:3 with points pt 5 ps 0.9 lc rgb '#38761d' title 'mortise, by what is known of the surfaces', \
  $peers using 1:3 with points pt 9 ps 1.1 lc rgb '#cc4125' title 'depth of the meshes against zero')",
      svg_file);
}

}  // namespace mortise::bench
