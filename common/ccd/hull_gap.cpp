#include "common/ccd/hull_gap.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/math/simplex.h"
#include "common/math/unit.h"

namespace mortise::ccd {
namespace {

// Overlapping hulls never get a plane; after this many steps there is one, or none exists.
constexpr int kStepsWithoutPlane = 12;
// The plane is as good as it gets when nothing of the gap but this share is left.
constexpr double kGoodPlane = 1e-13;
// How far a plane may be off, as a share of the gap; where boxes cannot tell more, to spare time.
constexpr double kSlack = 1e-3;

// Of the trees of both parts.
struct Leaves {
  std::int32_t a, b;
};

}  // namespace

bool leaves_above(const Bvh& bvh, const Vec3& n, double floor_mm, LeafList& list, int most) {
  const BvhWalk walk(bvh, n);
  list.count = 0;
  std::int32_t stack[Bvh::kMostWaiting];
  int top = 0;
  stack[top++] = bvh.root;
  while (top > 0) {
    const std::int32_t child = stack[--top];
    if (child < 0) {
      const Bvh::Leaf& leaf = bvh.leaves[~child];
      double highest = -std::numeric_limits<double>::infinity();
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
        for (int k = 0; k < 3; ++k) highest = std::max(highest, n.dot(bvh_corner(bvh, i, k)));
      if (highest <= floor_mm) continue;
      if (list.count >= std::min(most, kMostLeaves)) return false;
      list.leaf[list.count++] = {child, highest};
      continue;
    }
    const Bvh::Node& node = bvh.nodes[child];
    const BvhHeights h = walk.heights(node);
    for (int k = 0; k < node.count; ++k)
      if (static_cast<double>(h.value[k]) > floor_mm) stack[top++] = node.child[k];
  }
  return true;
}

// 1. the corners farthest along the direction from the nearest point so far;
// 2. the plane between them is a bound; the best is kept;
// 3. the corners join the simplex, whose point nearest to the origin gives the next direction.
HullGap hull_gap(const PairMotion& motion, const Bvh& a, const Bvh& b, const Vec3& guess,
                 int most_steps) {
  const PairState& s = motion.state();
  HullGap best;
  best.gap_mm = -std::numeric_limits<double>::infinity();
  Simplex<Leaves> simplex;
  Support on_a, on_b;
  Vec3 v = guess;
  double size = std::numeric_limits<double>::infinity();
  for (int step = 0; step < most_steps; ++step) {
    const double length = v.norm();
    if (!(length > 0.0)) break;
    const Vec3 n = v / length;
    on_a = support(a, s.R.transpose() * n, on_a, kSlack * length);
    on_b = support(b, -n, on_b, kSlack * length);
    const Vec3 x = s.R * on_a.point + s.p;
    const Vec3 w = on_b.point - x;
    const double far_a = n.dot(s.p) + on_a.bound_mm, near_b = -on_b.bound_mm;
    if (near_b - far_a > best.gap_mm) {
      best.gap_mm = near_b - far_a;
      best.n = n;
      best.far_a_mm = far_a;
      best.near_b_mm = near_b;
    }
    if (step >= kStepsWithoutPlane && best.gap_mm <= 0.0) break;
    bool known = n.dot(w) >= size * (1.0 - kGoodPlane);
    for (int k = 0; k < simplex.count; ++k) known = known || simplex.point[k] == w;
    if (known) break;
    simplex.add(w, {on_a.leaf, on_b.leaf});
    v = simplex.nearest();
    const double now = v.norm();
    if (!(now < size) || simplex.count == 4) break;
    size = now;
  }
  best.apart = best.gap_mm > motion.rounding_mm();
  MORTISE_CHECK(!best.apart || is_unit(best.n), "hulls are apart along a unit direction");
  best.pairs = simplex.count;
  for (int k = 0; k < simplex.count; ++k) {
    best.leaf_a[k] = simplex.tag[k].a;
    best.leaf_b[k] = simplex.tag[k].b;
  }
  return best;
}

}  // namespace mortise::ccd
