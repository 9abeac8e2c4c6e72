#include "tests/bench/plot_labels.h"

#include <algorithm>

namespace mortise::bench {
namespace {

// Of a sans serif font of 11 points, pixels; wide enough for most letters.
constexpr double kLetter = 6.1, kLine = 14.0;
constexpr double kAside = 8.0, kAbove = 15.0;

PixelBox box_of(const Placed& placed, const std::string& text) {
  const double length = kLetter * static_cast<double>(text.size());
  const double x0 = placed.to_the_left ? placed.x - length : placed.x;
  return {x0, placed.y - 0.5 * kLine, x0 + length, placed.y + 0.5 * kLine};
}

}  // namespace

Placed LabelPlaces::place(double x, double y, const std::string& text) {
  const Placed right{x + kAside, y, false};
  const double from = std::max(0.0, x - kAside), to = std::min(width_, x + kAside);
  for (const Placed& candidate :
       {right, Placed{to, y + kAbove, true}, Placed{from, y + kAbove, false},
        Placed{to, y - kAbove, true}, Placed{from, y - kAbove, false},
        Placed{to, y + 2 * kAbove, true}, Placed{to, y - 2 * kAbove, true},
        Placed{from, y - 2 * kAbove, false}, Placed{to, y + 3 * kAbove, true}}) {
    const PixelBox box = box_of(candidate, text);
    const bool inside = box.x0 >= 0 && box.x1 <= width_ && box.y0 >= 0 && box.y1 <= height_;
    if (!inside || std::any_of(taken_.begin(), taken_.end(),
                               [&](const PixelBox& other) { return other.meets(box); }))
      continue;
    take(box);
    return candidate;
  }
  take(box_of(right, text));
  return right;
}

}  // namespace mortise::bench
