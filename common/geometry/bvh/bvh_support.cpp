#include "common/geometry/bvh/bvh_support.h"

#include <algorithm>
#include <limits>

namespace mortise {
namespace {

// Float arithmetic of one height of a box: ten operations of 6e-8 each, on sums of three products.
constexpr double kFloatRounding = 2e-6;

}  // namespace

BvhWalk::BvhWalk(const Bvh& bvh, const Vec3& direction) {
  for (int c = 0; c < 3; ++c) n[c] = static_cast<float>(direction[c]);
  allowance = static_cast<float>(kFloatRounding * bvh.radius_mm);
}

Support support(const Bvh& bvh, const Vec3& n, const Support& hint, double slack_mm) {
  const BvhWalk walk(bvh, n);
  Support best = hint;
  best.along_mm = hint.leaf < 0 ? n.dot(hint.point) : -std::numeric_limits<double>::infinity();
  // Boxes of which all but the rounding is reached are left alone, else a flat face would be
  // searched through from end to end.
  const double left_mm = std::min(2.0 * static_cast<double>(walk.allowance), slack_mm);
  double left_alone = best.along_mm;
  const auto skip = [&](float height) {
    if (static_cast<double>(height) > best.along_mm + left_mm) return false;
    left_alone = std::max(left_alone, static_cast<double>(height));
    return true;
  };
  struct Waiting {
    std::int32_t child;
    float height;
  };
  Waiting stack[Bvh::kMostWaiting];
  int top = 0;
  stack[top++] = {bvh.root, std::numeric_limits<float>::infinity()};
  while (top > 0) {
    const Waiting item = stack[--top];
    if (skip(item.height)) continue;
    if (item.child < 0) {
      const Bvh::Leaf& leaf = bvh.leaves[~item.child];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
        for (int k = 0; k < 3; ++k) {
          const Vec3 x = bvh_corner(bvh, i, k);
          const double along = n.dot(x);
          if (along > best.along_mm) best = {along, along, x, item.child};
        }
      continue;
    }
    const Bvh::Node& node = bvh.nodes[item.child];
    const BvhHeights h = walk.heights(node);
    const int begin = top;
    for (int k = 0; k < node.count; ++k) {
      if (skip(h.value[k])) continue;
      int at = top++;
      for (; at > begin && stack[at - 1].height > h.value[k]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[k], h.value[k]};
    }
  }
  best.bound_mm = std::max(best.along_mm, left_alone);
  return best;
}

}  // namespace mortise
