#include "tests/bench/plot.h"

#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/bench/plot_labels.h"

namespace mortise::bench {
namespace {

// The plotted area: its size in pixels, at its place in the picture, and the axes' ranges.
constexpr double kPicture[2] = {960, 600};
constexpr double kArea[4] = {0.085, 0.115, 0.985, 0.985};  // left, bottom, right, top
// Left out of labels, which say "sub-steps" anyway.
const std::string kTest = "FCL collide,";
constexpr double kLeastError_mm = 1e-10, kMostError_mm = 1e3;

struct Axes {
  double least_ms, most_ms;
  double width() const { return (kArea[2] - kArea[0]) * kPicture[0]; }
  double height() const { return (kArea[3] - kArea[1]) * kPicture[1]; }
  double x(double error_mm) const {
    return width() * std::log10(std::max(kLeastError_mm, error_mm) / kLeastError_mm) /
           std::log10(kMostError_mm / kLeastError_mm);
  }
  double y(double time_ms) const {
    return height() * std::log10(time_ms / least_ms) / std::log10(most_ms / least_ms);
  }
};

std::string format(const char* pattern, double a, double b, double c = 0.0) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

// A decade more than the marks need on top: the key stands there.
Axes axes_of(const std::vector<Mark>& marks) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Mark& mark : marks) {
    least = std::min(least, mark.time_ms);
    most = std::max(most, mark.time_ms);
  }
  return {std::pow(10.0, std::floor(std::log10(0.6 * least))),
          std::pow(10.0, std::ceil(std::log10(3.0 * most)))};
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

std::string labels_of(const std::vector<Mark>& marks, const Axes& axes) {
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

std::string script_of(const std::vector<Mark>& marks, const std::string& svg_file) {
  const Axes axes = axes_of(marks);
  std::string text = block("ours", marks, [](const Mark& m) { return m.ours; }) +
                     block("early", marks, [](const Mark& m) { return !m.ours && !m.late; }) +
                     block("late", marks, [](const Mark& m) { return !m.ours && m.late; }) +
                     block("front", front_of(marks), [](const Mark&) { return true; });
  text += labels_of(marks, axes);
  const bool late =
      std::any_of(marks.begin(), marks.end(), [](const Mark& m) { return m.ours && m.late; });
  text += std::string("ours_title = 'mortise, asked for 10^{-9} to 10^{-2} mm: ") +
          (late ? "SOME LATE'\n" : "never late'\n");
  text += format("set yrange [%g:%g]\n", axes.least_ms, axes.most_ms);
  text += format("set xrange [%g:%g]\n", kLeastError_mm, kMostError_mm);
  text += format("set lmargin at screen %g\nset bmargin at screen %g\n", kArea[0], kArea[1]);
  text += format("set rmargin at screen %g\nset tmargin at screen %g\n", kArea[2], kArea[3]);
  text += R"(set logscale xy
set format x '10^{%T}'
set xlabel 'error of the time of contact, as travel, mm (mark: p99, whisker: from the median)'
set ylabel 'CPU time of a query, ms (geometric mean, one thread)'
set grid xtics ytics lc rgb '#dddddd' lt 1
set border 3 lc rgb '#444444'
set tics nomirror
set key top left reverse Left samplen 2 spacing 1.2
draw = "plot $front using 1:3 with fsteps lw 7 lc rgb '#cfe8c5' title 'Pareto front of those that miss nothing', \
  $early using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#9fc5e8' notitle, \
  $late using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#f4b6a0' notitle, \
  $ours using 1:3 with linespoints lw 2 pt 5 ps 0.8 lc rgb '#38761d' title ours_title, \
  $early using 1:3 with points pt 7 ps 0.9 lc rgb '#1155cc' title 'peers, early at most (safe)', \
  $late using 1:3 with points pt 9 ps 1.1 lc rgb '#cc4125' title 'peers, late (parts overlap by then) or missing contacts'"
)";
  const std::string png = svg_file.substr(0, svg_file.rfind(".svg")) + ".png";
  text += format("set terminal svg size %g,%g font 'sans,13' background '#ffffff'\n", kPicture[0],
                 kPicture[1]);
  text += "set output " + quoted_for_gnuplot(svg_file) + "\neval draw\n";
  text += format("set terminal pngcairo size %g,%g font 'sans,10' background '#ffffff'\n",
                 kPicture[0], kPicture[1]);
  text += "set output " + quoted_for_gnuplot(png) + "\neval draw\nset output\n";
  return text;
}

}  // namespace

std::string quoted_for_gnuplot(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

bool run_gnuplot(const std::string& script) {
  std::FILE* gnuplot = popen("gnuplot -", "w");
  if (gnuplot == nullptr) {
    std::fprintf(stderr, "no picture: a child process could not be started\n");
    return false;
  }
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  const int status = pclose(gnuplot);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  std::fprintf(stderr, WIFEXITED(status) && WEXITSTATUS(status) == 127
                           ? "no picture: gnuplot is not installed (package gnuplot-nox)\n"
                           : "no picture: gnuplot failed, see its words above\n");
  return false;
}

bool draw_time_against_error(const std::vector<Mark>& marks, const std::string& svg_file) {
  return !marks.empty() && run_gnuplot(script_of(marks, svg_file));
}

}  // namespace mortise::bench
