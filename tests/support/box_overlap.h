#pragma once
#include <algorithm>
#include <limits>

#include "common/session/world/world.h"

namespace mortise {

// The box of a part, with every face where its band has it at least.
inline Vec3 least_half(const Part& part, bool with_band) {
  const double inward_mm = with_band ? -part.band.faces[0].tolerance_mm.lo : 0.0;
  return part.solid->bounds().half() - Vec3::Constant(inward_mm);
}

// Depth by which two solid boxes overlap, mm: the least overlap over the 15 axes; <= 0 when apart.
inline double box_overlap_mm(const Part& a, const Part& b, bool with_band = false) {
  const Mat3 A = a.X_WP.rotation(), B = b.X_WP.rotation();
  const Vec3 half_a = least_half(a, with_band), half_b = least_half(b, with_band);
  const Vec3 d = a.X_WP * a.solid->bounds().center() - b.X_WP * b.solid->bounds().center();
  double least = 1e300;
  const auto look_along = [&](const Vec3& axis) {
    const double length = axis.norm();
    if (length < 1e-9) return;
    const Vec3 n = axis / length;
    const double reach =
        half_a.dot((A.transpose() * n).cwiseAbs()) + half_b.dot((B.transpose() * n).cwiseAbs());
    least = std::min(least, reach - std::abs(d.dot(n)));
  };
  for (int i = 0; i < 3; ++i) {
    look_along(A.col(i));
    look_along(B.col(i));
    for (int j = 0; j < 3; ++j) look_along(A.col(i).cross(B.col(j)));
  }
  return least;
}

inline constexpr std::uint32_t kFrame = 4;  // id of the part that is not one box

inline double deepest_overlap_mm(const World& world, bool with_bands = false) {
  double deepest = -1e300;
  for (const Part& a : world.parts)
    for (const Part& b : world.parts) {
      if (a.id >= b.id || (!a.moving && !b.moving)) continue;
      if (a.id.value == kFrame || b.id.value == kFrame) continue;
      deepest = std::max(deepest, box_overlap_mm(a, b, with_bands));
    }
  return deepest;
}

}  // namespace mortise
