#include "client/picture/heat.h"

#include <algorithm>
#include <cmath>

#include "client/picture/class_colours.h"
#include "client/picture/draw.h"

namespace mortise {
namespace {

// Real needs a width to deepen in where the other zones have none.
constexpr double kLeastReal_mm = 0.005;

double share(double x, double lo, double hi) {
  return hi > lo && std::isfinite(hi - lo) ? std::clamp((x - lo) / (hi - lo), 0.0, 1.0) : 0.0;
}

}  // namespace

double Heat::share() const {
  return zone == CollisionClass::kNone ? 0.0 : (static_cast<int>(zone) - 1 + within) / 3.0;
}

Heat heat_of(const ContactMark& mark) {
  const double from = std::min(0.0, mark.fake_below_mm), real = mark.real_above_mm;
  switch (mark.collision_class) {
    case CollisionClass::kReal:
      return {mark.collision_class,
              share(mark.overlap_mm, real, real + std::max(kLeastReal_mm, 0.5 * (real - from)))};
    case CollisionClass::kPotential:
      return {mark.collision_class, share(mark.overlap_mm, mark.fake_below_mm, real)};
    case CollisionClass::kFake:
      return {mark.collision_class, share(mark.overlap_mm, from, mark.fake_below_mm)};
    case CollisionClass::kNone:
      break;
  }
  return {};
}

Color color_of(const Heat& heat) {
  const ClassColours colours = class_colours(heat.zone);
  const Color a = color_of_hex(colours.heat_light), b = color_of_hex(colours.heat_deep);
  const auto mix = [&](double x, double y) { return x + heat.within * (y - x); };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

}  // namespace mortise
