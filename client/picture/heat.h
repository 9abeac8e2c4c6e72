#pragma once
#include <compare>

#include "client/picture/part_view.h"

namespace mortise {

/// Where a clash stands on the scale of its thresholds: the zone of its class, and how deep within
/// that, 0 to 1. Ordered by how bad.
struct Heat {
  CollisionClass zone = CollisionClass::kNone;
  double within = 0.0;
  /// Of the whole scale, 0 to 1: the zones are equally tall.
  double share() const;
  friend auto operator<=>(const Heat&, const Heat&) = default;
};
Heat heat_of(const ContactMark& mark);

/// The colour of the zone, deeper within it.
Color color_of(const Heat& heat);

}  // namespace mortise
