#pragma once
#include <ccd/ccd.h>

#include <vector>

#include "common/math/types.h"

namespace mortise::bench {

/// For libccd: a hull by its points, std::vector<Vec3>.
inline void farthest_of_points(const void* points, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const Vec3 n(direction->v[0], direction->v[1], direction->v[2]);
  const auto& all = *static_cast<const std::vector<Vec3>*>(points);
  const Vec3* best = all.data();
  for (const Vec3& x : all)
    if (n.dot(x) > n.dot(*best)) best = &x;
  ccdVec3Set(out, best->x(), best->y(), best->z());
}

inline ccd_t ccd_of_points() {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = farthest_of_points;
  ccd.max_iterations = 500;
  ccd.epa_tolerance = 1e-6;
  return ccd;
}

}  // namespace mortise::bench
