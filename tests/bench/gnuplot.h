#pragma once
#include <cstdio>
#include <string>

namespace mortise::bench {

template <class... Numbers>
std::string format(const char* pattern, Numbers... numbers) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, numbers...);
  return text;
}

/// Logarithmic axes of a picture of CPU time (up) against error (to the right), and the plotted
/// area's pixels.
struct TimeErrorAxes {
  double least_ms = 0.0, most_ms = 0.0, least_mm = 0.0, most_mm = 0.0;
  double width() const;
  double height() const;
  double x(double error_mm) const;  ///< pixels from the left of the area
  double y(double time_ms) const;   ///< pixels from its bottom
};

/// What stands around the marks.
struct TimeErrorWords {
  std::string x_label, y_label;
};

/// Runs `marks` (data blocks and labels), then `draw` (a plot command) with the axes around it:
/// SVG, and a PNG beside it. Says on stderr why when it cannot, and returns false.
bool draw_picture(const TimeErrorAxes& axes, const TimeErrorWords& words, const std::string& marks,
                  const std::string& draw, const std::string& svg_file);

/// A text in gnuplot's single quotes, which know one escape: a quote is written twice.
std::string quoted_for_gnuplot(const std::string& text);

}  // namespace mortise::bench
