#include "common/ccd/hull_gap.h"

#include <algorithm>
#include <cmath>

namespace mortise::ccd {
namespace {

// Float arithmetic of one height of a box: ten operations of 6e-8 each, on sums of three products.
constexpr double kFloatRounding = 2e-6;

// Overlapping hulls never get a plane; after this many steps there is one, or none exists.
constexpr int kStepsWithoutPlane = 12;
// The plane is as good as it gets when nothing of the gap but this share is left.
constexpr double kGoodPlane = 1e-13;
// How far a plane may be off, as a share of the gap; where boxes cannot tell more, to spare time.
constexpr double kSlack = 1e-3;

struct Heights {
  float value[Bvh::kWidth];
};

// Upper bound of n . x over each child.
Heights heights(const Bvh::Node& node, const float* n, float allowance) {
  Heights h;
  for (int k = 0; k < Bvh::kWidth; ++k)
    h.value[k] = n[0] * node.local_center[0][k] + n[1] * node.local_center[1][k] +
                 n[2] * node.local_center[2][k] +
                 (std::fabs(n[0]) * node.half[0][k] + std::fabs(n[1]) * node.half[1][k] +
                  std::fabs(n[2]) * node.half[2][k]) +
                 allowance;
  return h;
}

Vec3 corner(const Bvh& bvh, std::uint32_t i, int k) {
  const auto& c = bvh.corners[i];
  return Vec3(c[3 * k], c[3 * k + 1], c[3 * k + 2]) - bvh.origin;
}

struct Walk {
  float n[3], allowance;
  Walk(const Bvh& bvh, const Vec3& direction) {
    for (int c = 0; c < 3; ++c) n[c] = static_cast<float>(direction[c]);
    allowance = static_cast<float>(kFloatRounding * bvh.radius_mm);
  }
};

// Distance of the hull of up to four points from the origin; keeps the points that carry it.
struct Simplex {
  int count = 0;
  Vec3 point[4];
  std::int32_t leaf_a[4], leaf_b[4];

  // The point nearest to the origin within the hull of the points in `set`, if it lies inside of
  // their affine hull's face: barycentric coordinates all positive.
  bool foot(unsigned set, Vec3& at) const {
    int index[4], n = 0;
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

Support support(const Bvh& bvh, const Vec3& n, const Support& hint, double slack_mm) {
  const Walk walk(bvh, n);
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
          const Vec3 x = corner(bvh, i, k);
          const double along = n.dot(x);
          if (along > best.along_mm) best = {along, along, x, item.child};
        }
      continue;
    }
    const Bvh::Node& node = bvh.nodes[item.child];
    const Heights h = heights(node, walk.n, walk.allowance);
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

bool leaves_above(const Bvh& bvh, const Vec3& n, double floor_mm, LeafList& list, int most) {
  const Walk walk(bvh, n);
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
        for (int k = 0; k < 3; ++k) highest = std::max(highest, n.dot(corner(bvh, i, k)));
      if (highest <= floor_mm) continue;
      if (list.count >= std::min(most, kMostLeaves)) return false;
      list.leaf[list.count++] = {child, highest};
      continue;
    }
    const Bvh::Node& node = bvh.nodes[child];
    const Heights h = heights(node, walk.n, walk.allowance);
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
