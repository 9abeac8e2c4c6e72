#include "common/ccd/hull_gap.h"

#include <algorithm>
#include <cmath>

namespace mortise::ccd {
namespace {

// Overlapping hulls never get a plane; after this many steps there is one, or none exists.
constexpr int kStepsWithoutPlane = 12;
// The plane is as good as it gets when nothing of the gap but this share is left.
constexpr double kGoodPlane = 1e-13;
// How far a plane may be off, as a share of the gap; where boxes cannot tell more, to spare time.
constexpr double kSlack = 1e-3;

// Distance of the hull of up to four points from the origin; keeps the points that carry it.
struct Simplex {
  int count = 0;
  Vec3 point[4];
  std::int32_t leaf_a[4], leaf_b[4];

  // The point nearest to the origin within the hull of the points in `set`, if it lies inside of
  // their affine hull's face: barycentric coordinates all positive.
  bool foot(unsigned set, Vec3& at) const {
    int index[4] = {}, n = 0;
    for (int k = 0; k < count; ++k)
      if (set >> k & 1U) index[n++] = k;
    const Vec3& o = point[index[0]];
    if (n == 1) {
      at = o;
      return true;
    }
    const Vec3 e1 = point[index[1]] - o;
    if (n == 2) {
      const double ee = e1.squaredNorm(), s = -o.dot(e1);
      if (!(s > 0.0 && s < ee)) return false;
      at = o + e1 * (s / ee);
      return true;
    }
    const Vec3 e2 = point[index[2]] - o;
    if (n == 3) {
      const Vec3 normal = e1.cross(e2);
      const double nn = normal.squaredNorm();
      if (!(nn > 0.0)) return false;
      const double u = normal.dot((-o).cross(e2)), v = normal.dot(e1.cross(-o));
      if (!(u > 0.0 && v > 0.0 && u + v < nn)) return false;
      at = normal * (normal.dot(o) / nn);
      return true;
    }
    const Vec3 e3 = point[index[3]] - o;
    const double volume = e1.dot(e2.cross(e3)), sign = volume > 0.0 ? 1.0 : -1.0;
    const double u = sign * (-o).dot(e2.cross(e3)), v = sign * e1.dot((-o).cross(e3)),
                 w = sign * e1.dot(e2.cross(-o));
    if (!(u > 0.0 && v > 0.0 && w > 0.0 && u + v + w < sign * volume)) return false;
    at = Vec3::Zero();
    return true;
  }

  Vec3 nearest() {
    double best2 = std::numeric_limits<double>::infinity();
    Vec3 best = Vec3::Zero();
    unsigned best_set = 1;
    for (unsigned set = 1; set < (1U << count); ++set) {
      Vec3 at;
      if (!foot(set, at) || !(at.squaredNorm() < best2)) continue;
      best2 = at.squaredNorm();
      best = at;
      best_set = set;
    }
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      if (!(best_set >> k & 1U)) continue;
      point[kept] = point[k];
      leaf_a[kept] = leaf_a[k];
      leaf_b[kept++] = leaf_b[k];
    }
    count = kept;
    return best;
  }
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
  Simplex simplex;
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
    simplex.point[simplex.count] = w;
    simplex.leaf_a[simplex.count] = on_a.leaf;
    simplex.leaf_b[simplex.count++] = on_b.leaf;
    v = simplex.nearest();
    const double now = v.norm();
    if (!(now < size) || simplex.count == 4) break;
    size = now;
  }
  best.apart = best.gap_mm > motion.rounding_mm();
  best.pairs = simplex.count;
  for (int k = 0; k < simplex.count; ++k) {
    best.leaf_a[k] = simplex.leaf_a[k];
    best.leaf_b[k] = simplex.leaf_b[k];
  }
  return best;
}

}  // namespace mortise::ccd
