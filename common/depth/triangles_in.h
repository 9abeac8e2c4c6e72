#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "common/geometry/bvh/bvh.h"
#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// Between two planes across a direction; without one, all of space. Frame of a part, mm.
struct Slab {
  Vec3 normal = Vec3::Zero();
  Interval between_mm;  ///< normal . x

  bool is_beside(const std::array<double, 9>& corners) const {
    using Corner = Eigen::Map<const Vec3>;
    const double a = normal.dot(Corner(&corners[0])), b = normal.dot(Corner(&corners[3])),
                 c = normal.dot(Corner(&corners[6]));
    return std::min({a, b, c}) > between_mm.hi || std::max({a, b, c}) < between_mm.lo;
  }
};

namespace triangles_in {

/// A box and a slab as the boxes of a tree see them, which are about its origin.
class Sieve {
 public:
  Sieve(const Bvh& bvh, const Box& box, const Slab& slab)
      : center_(box.center() - bvh.origin),
        half_(box.half()),
        normal_(slab.normal),
        middle_mm_(slab.between_mm.middle() - slab.normal.dot(bvh.origin)) {
    constexpr double kRounding = 1e-12;  // of the sums below, with room
    const double half_mm = 0.5 * slab.between_mm.width();
    half_mm_ = half_mm + kRounding * (bvh.radius_mm + bvh.extent_mm + std::fabs(middle_mm_));
  }

  /// By lane: no more than zero where the box of a child may reach into both.
  void gaps(const Bvh::Node& node, double (&gap)[Bvh::kWidth]) const {
    for (int k = 0; k < Bvh::kWidth; ++k) gap[k] = beyond_box(node, 0, k);
    for (int c = 1; c < 3; ++c)
      for (int k = 0; k < Bvh::kWidth; ++k) gap[k] = std::max(gap[k], beyond_box(node, c, k));
    if (normal_.isZero(0.0)) return;
    for (int k = 0; k < Bvh::kWidth; ++k) {
      double across = 0.0, half_across = 0.0;
      for (int c = 0; c < 3; ++c) {
        across += normal_[c] * static_cast<double>(node.local_center[c][k]);
        half_across += std::fabs(normal_[c]) * static_cast<double>(node.half[c][k]);
      }
      gap[k] = std::max(gap[k], std::fabs(across - middle_mm_) - half_across - half_mm_);
    }
  }

 private:
  double beyond_box(const Bvh::Node& node, int c, int k) const {
    return std::fabs(center_[c] - static_cast<double>(node.local_center[c][k])) -
           static_cast<double>(node.half[c][k]) - half_[c];
  }

  Vec3 center_, half_, normal_;
  double middle_mm_, half_mm_ = 0.0;
};

inline bool are_apart(const std::array<double, 9>& corners, const Box& box) {
  bool apart = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = corners[k], b = corners[3 + k], c = corners[6 + k];
    apart |= std::min(a, std::min(b, c)) > box.hi[static_cast<int>(k)] ||
             std::max(a, std::max(b, c)) < box.lo[static_cast<int>(k)];
  }
  return apart;
}

}  // namespace triangles_in

/// Calls visit(triangle, corners) for every triangle whose box is within the given box and that is
/// not beside the slab (part frame). A visit that tells false ends it.
template <class Visit>
void for_each_triangle_in(const Bvh& bvh, const Box& box, const Slab& slab, Visit&& visit) {
  std::array<std::int32_t, Bvh::kMostWaiting> stack;
  int top = 0;
  stack[top++] = bvh.root;
  const triangles_in::Sieve sieve(bvh, box, slab);
  while (top > 0) {
    const std::int32_t child = stack[--top];
    if (child < 0) {
      const Bvh::Leaf& leaf = bvh.leaves[~child];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const std::array<double, 9>& c = bvh.corners[i];
        if (triangles_in::are_apart(c, box) || slab.is_beside(c)) continue;
        const std::array<Vec3, 3> corners = {Vec3(c[0], c[1], c[2]), Vec3(c[3], c[4], c[5]),
                                             Vec3(c[6], c[7], c[8])};
        if constexpr (std::is_same_v<std::invoke_result_t<Visit, std::uint32_t, decltype(corners)>,
                                     bool>) {
          if (!visit(bvh.triangle_order[i], corners)) return;
        } else {
          visit(bvh.triangle_order[i], corners);
        }
      }
      continue;
    }
    const Bvh::Node& node = bvh.nodes[child];
    double gap[Bvh::kWidth];
    sieve.gaps(node, gap);
    for (int k = node.count - 1; k >= 0; --k)
      if (gap[k] <= 0.0) stack[top++] = node.child[k];
  }
}

/// The same without a slab.
template <class Visit>
void for_each_triangle_in(const Bvh& bvh, const Box& box, Visit&& visit) {
  for_each_triangle_in(bvh, box, Slab{}, std::forward<Visit>(visit));
}

}  // namespace mortise
