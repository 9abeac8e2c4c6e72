#pragma once
#include "common/geometry/feature.h"

namespace mortise {

/// Between chord and arc of a round of 20 mm with 32 facets.
inline constexpr double kSagitta_mm = 0.048152733;

inline Surface cylinder(double radius_mm, bool inward) {
  Surface s;
  s.kind = SurfaceKind::kCylinder;
  s.radius_mm = radius_mm;
  s.inward = inward;
  return s;
}

}  // namespace mortise
