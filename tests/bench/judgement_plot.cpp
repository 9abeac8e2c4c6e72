#include "tests/bench/judgement_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/bench/plot.h"
#include "tests/bench/plot_labels.h"

namespace mortise::bench {
namespace {

constexpr double kPicture[2] = {960, 560};
constexpr double kArea[4] = {0.085, 0.12, 0.985, 0.97};  // left, bottom, right, top
constexpr double kLeastError_mm = 1e-8;

struct Axes {
  double least_ms = 1e9, most_ms = 0.0, most_mm = 1e-2;
  double width() const { return (kArea[2] - kArea[0]) * kPicture[0]; }
  double height() const { return (kArea[3] - kArea[1]) * kPicture[1]; }
  double x(double mm) const {
    return width() * std::log10(std::max(kLeastError_mm, mm) / kLeastError_mm) /
           std::log10(most_mm / kLeastError_mm);
  }
  double y(double ms) const {
    return height() * std::log10(ms / least_ms) / std::log10(most_ms / least_ms);
  }
};

template <class... Numbers>
std::string format(const char* pattern, Numbers... numbers) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, numbers...);
  return text;
}

Axes axes_of(const std::vector<JudgementMark>& marks) {
  Axes axes;
  for (const JudgementMark& mark : marks) {
    axes.least_ms = std::min(axes.least_ms, mark.time_ms);
    axes.most_ms = std::max(axes.most_ms, mark.time_ms);
    axes.most_mm = std::max(axes.most_mm, mark.error_mm);
  }
  // Half a decade below, one above for the key, one to the right for the words.
  return {std::pow(10.0, std::floor(std::log10(0.5 * axes.least_ms))),
          std::pow(10.0, std::ceil(std::log10(4.0 * axes.most_ms))),
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

std::string labels_of(const std::vector<JudgementMark>& marks, const Axes& axes) {
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
  const Axes axes = axes_of(marks);
  std::string text = block("ours", marks, true) + block("peers", marks, false);
  text += labels_of(marks, axes);
  text += format("set xrange [%g:%g]\nset yrange [%g:%g]\n", kLeastError_mm, axes.most_mm,
                 axes.least_ms, axes.most_ms);
  text += format("set lmargin at screen %g\nset bmargin at screen %g\n", kArea[0], kArea[1]);
  text += format("set rmargin at screen %g\nset tmargin at screen %g\n", kArea[2], kArea[3]);
  text += R"(set logscale xy
set format x '10^{%T}'
set xlabel 'error of the overlap of the true surfaces, mm (mark: p99, whisker: from the median)'
set ylabel 'CPU time of a pair, ms (median, one thread)'
set grid xtics ytics lc rgb '#dddddd' lt 1
set border 3 lc rgb '#444444'
set tics nomirror
set key top left reverse Left samplen 2 spacing 1.2
draw = "plot $ours using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#b6d7a8' notitle, \
  $peers using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#f4b6a0' notitle, \
  $ours using 1:3 with points pt 5 ps 0.9 lc rgb '#38761d' title 'mortise, by what is known of the surfaces', \
  $peers using 1:3 with points pt 9 ps 1.1 lc rgb '#cc4125' title 'depth of the meshes against zero'"
)";
  const std::string png = svg_file.substr(0, svg_file.rfind(".svg")) + ".png";
  text += format("set terminal svg size %g,%g font 'sans,13' background '#ffffff'\n", kPicture[0],
                 kPicture[1]);
  text += "set output " + quoted_for_gnuplot(svg_file) + "\neval draw\n";
  text += format("set terminal pngcairo size %g,%g font 'sans,10' background '#ffffff'\n",
                 kPicture[0], kPicture[1]);
  text += "set output " + quoted_for_gnuplot(png) + "\neval draw\nset output\n";
  return run_gnuplot(text);
}

}  // namespace mortise::bench
