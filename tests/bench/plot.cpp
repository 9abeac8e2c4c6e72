#include "tests/bench/plot.h"

#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mortise::bench {
namespace {

// Errors below this are drawn here, mm: a logarithm has no zero.
constexpr double kLeastError_mm = 1e-10;

std::string line_of(const Mark& mark) {
  std::string label = mark.name;
  if (mark.missed > 0) {
    label +=
        " (misses " + std::to_string(mark.missed) + " of " + std::to_string(mark.contacts) + ")";
  }
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, "%.6g %.6g %.6g ", std::max(kLeastError_mm, mark.error_mm),
                std::max(kLeastError_mm, mark.median_error_mm), mark.time_ms);
  return numbers + ("\"" + label + "\"\n");
}

template <class Keep>
std::string block(const std::string& name, const std::vector<Mark>& marks, Keep&& keep) {
  std::string text = "$" + name + " << EOD\n";
  for (const Mark& mark : marks)
    if (keep(mark)) text += line_of(mark);
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

// The range of the time, whole decades with room for labels.
std::string range_of(const std::vector<Mark>& marks) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Mark& mark : marks) {
    least = std::min(least, mark.time_ms);
    most = std::max(most, mark.time_ms);
  }
  char text[64];
  std::snprintf(text, sizeof text, "set yrange [%g:%g]\n",
                std::pow(10.0, std::floor(std::log10(0.5 * least))),
                std::pow(10.0, std::ceil(std::log10(1.5 * most))));
  return text;
}

std::string script_of(const std::vector<Mark>& marks, const std::string& svg_file) {
  std::string text = block("ours", marks, [](const Mark& m) { return m.ours; }) +
                     block("early", marks, [](const Mark& m) { return !m.ours && !m.late; }) +
                     block("late", marks, [](const Mark& m) { return !m.ours && m.late; }) +
                     block("front", front_of(marks), [](const Mark&) { return true; });
  text += range_of(marks);
  text += R"(set logscale xy
set xrange [1e-10:1e3]
set format x '10^{%T}'
set xlabel 'error of the time of contact, as travel, mm (mark: p99, whisker: from the median)'
set ylabel 'CPU time of a query, ms (geometric mean, one thread)'
set grid xtics ytics lc rgb '#dddddd' lt 1
set border 3 lc rgb '#444444'
set tics nomirror
set key top left reverse Left samplen 2 spacing 1.2
set lmargin 10
left_of(x) = (x < 1e-4 || x > 0.1) ? x : 1/0
right_of(x) = (x < 1e-4 || x > 0.1) ? 1/0 : x
draw = "plot $front using 1:3 with fsteps lw 6 lc rgb '#d9ead3' title 'Pareto front of those that miss nothing', \
  $early using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#9fc5e8' notitle, \
  $late using 2:3:($1-$2):(0) with vectors nohead lw 2 lc rgb '#f4b6a0' notitle, \
  $ours using 1:3 with linespoints lw 2 pt 5 ps 1 lc rgb '#38761d' title 'mortise, asked for 10^{-9} ... 10^{-2} mm: never late', \
  $early using 1:3 with points pt 7 ps 1.3 lc rgb '#1155cc' title 'peers, early at most (safe)', \
  $late using 1:3 with points pt 9 ps 1.6 lc rgb '#cc4125' title 'peers, late (parts overlap by then)', \
  $early using (left_of($1)):3:4 with labels right offset 1,0.8 font ',11' tc rgb '#1155cc' notitle, \
  $early using (right_of($1)):3:4 with labels left offset -1,0.8 font ',11' tc rgb '#1155cc' notitle, \
  $late using (left_of($1)):3:4 with labels right offset 1,0.8 font ',11' tc rgb '#cc4125' notitle, \
  $late using (right_of($1)):3:4 with labels left offset -1,0.8 font ',11' tc rgb '#cc4125' notitle"
)";
  // gnuplot's single quotes know one escape: a quote is written twice.
  const auto quoted = [](const std::string& file) {
    std::string out = "'";
    for (const char c : file) out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
  };
  const std::string png = svg_file.substr(0, svg_file.rfind(".svg")) + ".png";
  text += "set terminal svg size 960,600 font 'sans,13' background '#ffffff'\n";
  text += "set output " + quoted(svg_file) + "\neval draw\n";
  text += "set terminal pngcairo size 960,600 font 'sans,10' background '#ffffff'\n";
  text += "set output " + quoted(png) + "\neval draw\nset output\n";
  return text;
}

}  // namespace

bool draw_time_against_error(const std::vector<Mark>& marks, const std::string& svg_file) {
  if (marks.empty()) return false;
  std::FILE* gnuplot = popen("gnuplot -", "w");
  if (gnuplot == nullptr) {
    std::fprintf(stderr, "no picture: a child process could not be started\n");
    return false;
  }
  const std::string script = script_of(marks, svg_file);
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  const int status = pclose(gnuplot);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  std::fprintf(stderr, WIFEXITED(status) && WEXITSTATUS(status) == 127
                           ? "no picture: gnuplot is not installed (package gnuplot-nox)\n"
                           : "no picture: gnuplot failed, see its words above\n");
  return false;
}

}  // namespace mortise::bench
