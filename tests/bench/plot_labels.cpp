#include "tests/bench/plot_labels.h"

#include <algorithm>
#include <limits>

namespace mortise::bench {
namespace {

// Of a sans serif font of 11 points, pixels; wide enough for most letters.
constexpr double kLetter = 8.3, kLine = 14.0;
constexpr double kAside = 8.0, kStep = 7.5;
constexpr int kSteps = 8;

PixelBox box_of(const Placed& placed, const std::string& text) {
  const double length = kLetter * static_cast<double>(text.size());
  const double x0 = placed.to_the_left ? placed.x - length : placed.x;
  return {x0, placed.y - 0.5 * kLine, x0 + length, placed.y + 0.5 * kLine};
}

double common_area(const PixelBox& a, const PixelBox& b) {
  return std::max(0.0, std::min(a.x1, b.x1) - std::max(a.x0, b.x0)) *
         std::max(0.0, std::min(a.y1, b.y1) - std::max(a.y0, b.y0));
}

}  // namespace

Placed LabelPlaces::place(double x, double y, const std::string& text) {
  std::vector<Placed> candidates = {{x + kAside, y, false}};
  const double from = std::max(0.0, x - kAside), to = std::min(width_, x + kAside);
  for (int step = 2; step <= kSteps; ++step)
    for (const double away : {step * kStep, -step * kStep}) {
      candidates.push_back({to, y + away, true});
      candidates.push_back({from, y + away, false});
    }
  Placed best = candidates.front();
  double least = std::numeric_limits<double>::infinity();
  for (const Placed& candidate : candidates) {
    const PixelBox box = box_of(candidate, text);
    if (box.x0 < 0 || box.x1 > width_ || box.y0 < 0 || box.y1 > height_) continue;
    double covered = 0.0;
    for (const PixelBox& other : taken_) covered += common_area(box, other);
    if (covered >= least) continue;
    least = covered;
    best = candidate;
  }
  take(box_of(best, text));
  return best;
}

}  // namespace mortise::bench
