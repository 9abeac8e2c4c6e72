#include "tests/bench/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/gnuplot.h"
#include "tests/bench/plot_labels.h"

namespace mortise::bench {
namespace {

// Left out of labels, which say "sub-steps" anyway.
const std::string kTest = "FCL collide,";
constexpr double kLeastError_mm = 1e-10, kMostError_mm = 1e3;

// A decade more than the marks need on top: the key stands there.
TimeErrorAxes axes_of(const std::vector<Mark>& marks) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Mark& mark : marks) {
    least = std::min(least, mark.time_ms);
    most = std::max(most, mark.time_ms);
  }
  return {std::pow(10.0, std::floor(std::log10(0.6 * least))),
          std::pow(10.0, std::ceil(std::log10(3.0 * most))), kLeastError_mm, kMostError_mm};
}

template <class Keep>
std::string block(const std::string& name, const std::vector<Mark>& marks, Keep&& keep) {
  std::string text = "$" + name + " << EOD\n";
  for (const Mark& mark : marks)
    if (keep(mark))
      text += format("%.6g %.6g %.6g\n", std::max(kLeastError_mm, mark.error_mm),
                     std::max(kLeastError_mm, mark.median_error_mm), mark.time_ms);
  return text + "EOD\n";
}

// Methods that nothing beats in both time and error; a method that misses contacts is no answer.
std::vector<Mark> front_of(std::vector<Mark> marks) {
  std::erase_if(marks, [](const Mark& mark) { return mark.missed > 0; });
  std::sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) {
    return a.error_mm != b.error_mm ? a.error_mm < b.error_mm : a.time_ms < b.time_ms;
  });
  std::vector<Mark> front;
  double best_ms = std::numeric_limits<double>::infinity();
  for (const Mark& mark : marks)
    if (mark.time_ms < best_ms) {
      best_ms = mark.time_ms;
      front.push_back(mark);
    }
  return front;
}

std::string labels_of(const std::vector<Mark>& marks, const TimeErrorAxes& axes) {
  LabelPlaces places(axes.width(), axes.height());
  places.take({0, axes.height() - 100, 400, axes.height()});  // the key
  for (const Mark& mark : marks) {
    const double x = axes.x(mark.error_mm), y = axes.y(mark.time_ms);
    places.take({x - 7, y - 7, x + 7, y + 7});
    if (!mark.ours) places.take({axes.x(mark.median_error_mm), y - 2, x, y + 2});
  }
  std::string text;
  for (const Mark& mark : marks) {
    if (mark.ours) continue;
    std::string words = mark.name;
    if (words.starts_with(kTest)) words.replace(0, kTest.size(), "FCL,");
    if (mark.missed > 0)
      words += ", misses " + std::to_string(mark.missed) + " of " + std::to_string(mark.contacts);
    const Placed at = places.place(axes.x(mark.error_mm), axes.y(mark.time_ms), words);
    text += "set label " + quoted_for_gnuplot(words) +
            format(" at graph %.4f,%.4f ", at.x / axes.width(), at.y / axes.height()) +
            (at.to_the_left ? "right" : "left") + " font ',11' tc rgb '" +
            (mark.late ? "#cc4125" : "#1155cc") + "'\n";
  }
  return text;
}

}  // namespace

bool draw_time_against_error(const std::vector<Mark>& marks, const std::string& svg_file) {
  if (marks.empty()) return false;
  const TimeErrorAxes axes = axes_of(marks);
  std::string text = block("ours", marks, [](const Mark& m) { return m.ours; }) +
                     block("early", marks, [](const Mark& m) { return !m.ours && !m.late; }) +
                     block("late", marks, [](const Mark& m) { return !m.ours && m.late; }) +
                     block("front", front_of(marks), [](const Mark&) { return true; });
  text += labels_of(marks, axes);
  const bool late =
      std::any_of(marks.begin(), marks.end(), [](const Mark& m) { return m.ours && m.late; });
  text += std::string("ours_title = 'mortise, asked for 10^{-9} to 10^{-2} mm: ") +
          (late ? "SOME LATE'\n" : "never late'\n");
  return draw_picture(
      axes,
      {"error of the time of contact, as travel, mm (mark: p99, whisker: from the median)",
       "CPU time of a query, ms (geometric mean, one thread)"},
      text,
      R"(plot $front using 1:3 with fsteps lw 7 lc rgb '#cfe8c5' title 'Pareto front of those that miss nothing', \
  $early using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#9fc5e8' notitle, \
  $late using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#f4b6a0' notitle, \
  $ours using 1:3 with linespoints lw 2 pt 5 ps 0.8 lc rgb '#38761d' title ours_title, \
  $early using 1:3 with points pt 7 ps 0.9 lc rgb '#1155cc' title 'peers, early at most (safe)', \
  $late using 1:3 with points pt 9 ps 1.1 lc rgb '#cc4125' title 'peers, late (parts overlap by then) or missing contacts')",
      svg_file);
}

}  // namespace mortise::bench
