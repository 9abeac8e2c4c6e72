#pragma once
#include <cmath>
#include <cstdint>

#include "common/geometry/bvh/bvh.h"

// How far a mesh reaches along a direction, from its tree.
namespace mortise {

/// The corner of a mesh that is farthest along a direction, or one that is almost as far.
struct Support {
  double along_mm = 0.0;      ///< direction . point
  double bound_mm = 0.0;      ///< no corner is farther
  Vec3 point = Vec3::Zero();  ///< from the origin of the tree, axes of the part
  std::int32_t leaf = 0;      ///< < 0, as in Bvh::Node::child; 0: none yet
};

/// n: unit, axes of the part. O(log n) typical. `hint`: a corner of the mesh that may be far, or
/// none. A corner within slack_mm of the farthest is good enough.
Support support(const Bvh& bvh, const Vec3& n, const Support& hint, double slack_mm);

/// Heights of boxes along a direction, in single precision with what that may be off.
struct BvhHeights {
  float value[Bvh::kWidth];
};
struct BvhWalk {
  float n[3], allowance;
  BvhWalk(const Bvh& bvh, const Vec3& direction);
  /// Upper bounds of n . x over each child, from the origin of the tree.
  BvhHeights heights(const Bvh::Node& node) const {
    BvhHeights h;
    for (int k = 0; k < Bvh::kWidth; ++k)
      h.value[k] = n[0] * node.local_center[0][k] + n[1] * node.local_center[1][k] +
                   n[2] * node.local_center[2][k] +
                   (std::fabs(n[0]) * node.half[0][k] + std::fabs(n[1]) * node.half[1][k] +
                    std::fabs(n[2]) * node.half[2][k]) +
                   allowance;
    return h;
  }
};

/// Corner k of the i-th triangle in leaf order, from the origin of the tree.
inline Vec3 bvh_corner(const Bvh& bvh, std::uint32_t i, int k) {
  const auto& c = bvh.corners[i];
  return Vec3(c[3 * k], c[3 * k + 1], c[3 * k + 2]) - bvh.origin;
}

}  // namespace mortise
