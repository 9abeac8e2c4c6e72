#pragma once
#include <vector>

#include "client/picture/section.h"

namespace mortise {

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
  Color faded(double share) const { return {red, green, blue, alpha * share}; }
};

struct Pen {
  Color color;
  double width = 1.0;
  std::vector<double> dashes = {};
  double dash_from = 0.0;  ///< how far into the dashes a line begins
};

struct Box2 {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

}  // namespace mortise
