#pragma once
#include "common/ccd/distance.h"
#include "common/math/rotation.h"
#include "tests/unit/depth/cover_parts.h"

/// Pairs of random parts where they about touch.
namespace mortise::cover_parts {

struct DrawnPair {
  DrawnPart a, b;
  Pose X_BA;
};

inline Vec3 any_direction(Random& random) {
  for (;;) {
    const Vec3 v(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

inline double gap_mm(const DrawnPair& pair, const Pose& X_BA) {
  CcdScratch scratch;
  return distance(*pair.a.solid, X_BA, *pair.b.solid, Pose(), scratch).distance_mm;
}

/// A round somewhere along a bore of about its size, or any turn, moved up to the other part.
inline DrawnPair placed(Random& random, const DrawnPart& a, const DrawnPart& b) {
  DrawnPair pair{a, b, Pose()};
  const bool fits = pair.a.round_mm > 0.0 && pair.b.round_mm > 0.0 && below(random, 3) != 0;
  if (fits) {
    const Vec3 turn = below(random, 2) * uniform(random, 0.0, 2e-3) * any_direction(random) +
                      uniform(random, -3.0, 3.0) * Vec3::UnitZ();
    const double off = uniform(random, 0.0, 0.06);
    const Vec3 aside = off * any_direction(random);
    pair.X_BA.q = rotation_exp(turn);
    pair.X_BA.p = pair.b.axis_point - pair.X_BA.q * pair.a.axis_point +
                  Vec3(aside.x(), aside.y(),
                       uniform(random, -1.1 * pair.a.length_mm, 1.1 * pair.b.length_mm));
    return pair;
  }
  pair.X_BA.q = rotation_exp(uniform(random, 0.0, 3.1) * any_direction(random));
  if (below(random, 2) == 0) {
    const Vec3 axis = Vec3::Unit(below(random, 3));
    pair.X_BA.q = rotation_exp(0.5 * std::numbers::pi * below(random, 4) * axis +
                               below(random, 2) * 1e-3 * any_direction(random));
  }
  const Vec3 from = any_direction(random);
  double out = 150.0;
  for (int i = 0; i < 60; ++i) {
    const Pose X{pair.X_BA.q, out * from};
    const double gap = gap_mm(pair, X);
    if (gap < 1e-3) break;
    out -= 0.98 * gap;
    if (out < -150.0) break;
  }
  pair.X_BA.p = (out + uniform(random, -0.08, 0.15)) * from;
  return pair;
}

inline DrawnPair any_pair(Random& random) {
  const double r = uniform(random, 3.0, 12.0);
  const DrawnPart a = any_part(random, r);
  return placed(random, a, any_part(random, r + uniform(random, -0.05, 0.1)));
}

}  // namespace mortise::cover_parts
