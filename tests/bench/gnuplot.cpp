#include "tests/bench/gnuplot.h"

#include <sys/wait.h>

#include <algorithm>
#include <cmath>

namespace mortise::bench {
namespace {

constexpr double kPicture[2] = {960, 600};                 // pixels
constexpr double kArea[4] = {0.085, 0.115, 0.985, 0.985};  // left, bottom, right, top

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

}  // namespace

double TimeErrorAxes::width() const { return (kArea[2] - kArea[0]) * kPicture[0]; }
double TimeErrorAxes::height() const { return (kArea[3] - kArea[1]) * kPicture[1]; }
double TimeErrorAxes::x(double error_mm) const {
  return width() * std::log10(std::max(least_mm, error_mm) / least_mm) /
         std::log10(most_mm / least_mm);
}
double TimeErrorAxes::y(double time_ms) const {
  return height() * std::log10(time_ms / least_ms) / std::log10(most_ms / least_ms);
}

bool draw_picture(const TimeErrorAxes& axes, const TimeErrorWords& words, const std::string& marks,
                  const std::string& draw, const std::string& svg_file) {
  std::string text = marks;
  text += format("set xrange [%g:%g]\nset yrange [%g:%g]\n", axes.least_mm, axes.most_mm,
                 axes.least_ms, axes.most_ms);
  text += format("set lmargin at screen %g\nset bmargin at screen %g\n", kArea[0], kArea[1]);
  text += format("set rmargin at screen %g\nset tmargin at screen %g\n", kArea[2], kArea[3]);
  text += R"(set logscale xy
set format x '10^{%T}'
set grid xtics ytics lc rgb '#dddddd' lt 1
set border 3 lc rgb '#444444'
set tics nomirror
set key top left reverse Left samplen 2 spacing 1.2
)";
  text += "set xlabel " + quoted_for_gnuplot(words.x_label) + "\n";
  text += "set ylabel " + quoted_for_gnuplot(words.y_label) + "\n";
  const std::string png_file = svg_file.substr(0, svg_file.rfind(".svg")) + ".png";
  const auto draw_to = [&](const char* terminal, const std::string& file) {
    text += format("set terminal %s background '#ffffff' size %g,%g\n", terminal, kPicture[0],
                   kPicture[1]);
    text += "set output " + quoted_for_gnuplot(file) + "\n" + draw + "\n";
  };
  draw_to("svg font 'sans,13'", svg_file);
  draw_to("pngcairo font 'sans,10'", png_file);
  return run_gnuplot(text + "set output\n");
}

std::string quoted_for_gnuplot(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

}  // namespace mortise::bench
