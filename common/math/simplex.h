#pragma once
#include <limits>

#include "common/math/types.h"

namespace mortise {

/// The hull of up to four points, each with a tag. Gilbert, Johnson and Keerthi 1988.
template <class Tag>
struct Simplex {
  int count = 0;
  Vec3 point[4];
  Tag tag[4];
  double weight[4];  ///< of each point in the nearest one; their sum is 1

  void add(const Vec3& x, const Tag& tag_of) {
    point[count] = x;
    tag[count++] = tag_of;
  }

  /// The point nearest to the origin; keeps only the points that carry it: four where the origin is
  /// inside.
  Vec3 nearest() {
    double best2 = std::numeric_limits<double>::infinity();
    Vec3 best = Vec3::Zero();
    unsigned best_set = 1;
    Foot foot_at;
    for (unsigned set = 1; set < (1U << count); ++set) {
      if (!foot(set, foot_at) || !(foot_at.at.squaredNorm() < best2)) continue;
      best2 = foot_at.at.squaredNorm();
      best = foot_at.at;
      best_set = set;
      for (int k = 0; k < 4; ++k) weight[k] = foot_at.weight[k];
    }
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      if (!(best_set >> k & 1U)) continue;
      point[kept] = point[k];
      tag[kept++] = tag[k];
    }
    count = kept;
    return best;
  }

 private:
  struct Foot {
    Vec3 at;
    double weight[4];  // of the points of the set, in their order
    void set(const Vec3& x, double b = 0.0, double c = 0.0, double d = 0.0) {
      at = x;
      weight[0] = 1.0 - b - c - d;
      weight[1] = b;
      weight[2] = c;
      weight[3] = d;
    }
  };

  // The point nearest to the origin within the hull of the points in `set`, if it lies inside of
  // their affine hull's face: barycentric coordinates all positive.
  bool foot(unsigned set, Foot& foot) const {
    int index[4] = {}, n = 0;
    for (int k = 0; k < count; ++k)
      if (set >> k & 1U) index[n++] = k;
    const Vec3& o = point[index[0]];
    if (n == 1) {
      foot.set(o);
      return true;
    }
    const Vec3 e1 = point[index[1]] - o;
    if (n == 2) {
      const double ee = e1.squaredNorm(), s = -o.dot(e1);
      if (!(s > 0.0 && s < ee)) return false;
      foot.set(o + e1 * (s / ee), s / ee);
      return true;
    }
    const Vec3 e2 = point[index[2]] - o;
    if (n == 3) {
      const Vec3 normal = e1.cross(e2);
      const double nn = normal.squaredNorm();
      if (!(nn > 0.0)) return false;
      const double u = normal.dot((-o).cross(e2)), v = normal.dot(e1.cross(-o));
      if (!(u > 0.0 && v > 0.0 && u + v < nn)) return false;
      foot.set(normal * (normal.dot(o) / nn), u / nn, v / nn);
      return true;
    }
    const Vec3 e3 = point[index[3]] - o;
    const double volume = e1.dot(e2.cross(e3)), sign = volume > 0.0 ? 1.0 : -1.0;
    const double u = sign * (-o).dot(e2.cross(e3)), v = sign * e1.dot((-o).cross(e3)),
                 w = sign * e1.dot(e2.cross(-o));
    if (!(u > 0.0 && v > 0.0 && w > 0.0 && u + v + w < sign * volume)) return false;
    const double all = sign * volume;
    foot.set(Vec3::Zero(), u / all, v / all, w / all);
    return true;
  }
};

}  // namespace mortise
