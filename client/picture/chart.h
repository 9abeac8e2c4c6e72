#pragma once
#include <cmath>

#include "client/picture/section.h"

namespace mortise {

/// Coordinates of a cut about a nominal line through its origin: s along the line, h above it,
/// towards the cut's `up`; mm. A circle, whose centre lies below, is unrolled, so that a shaft and
/// its bore lie one above the other as straight lines and only what deviates from them is seen.
struct Chart {
  Vec2 center = Vec2::Zero();  ///< of the circle, in the cut
  double radius_mm = 0.0;      ///< 0: the line is straight, and s, h are the cut's own x, y

  bool straight() const { return radius_mm <= 0.0; }

  Vec2 to_chart(const Vec2& x) const {
    if (straight()) return x;
    const Vec2 d = x - center;
    return {radius_mm * std::atan2(d.x(), d.y()), d.norm() - radius_mm};
  }

  Vec2 to_cut(const Vec2& sh) const {
    if (straight()) return sh;
    const double angle = sh.x() / radius_mm;
    return center + (radius_mm + sh.y()) * Vec2(std::sin(angle), std::cos(angle));
  }
};

}  // namespace mortise
