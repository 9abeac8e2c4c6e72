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
  /// inside. To be asked after each point that is added.
  Vec3 nearest() {
    const int last = count - 1;
    // Of those before the last one it is the one that they carried: only sets with the last can
    // have a nearer one.
    double best2 = nearest_.squaredNorm();
    unsigned best_set = (1U << last) - 1;
    for (unsigned before = 0; before < (1U << last); ++before) {
      Foot foot;
      if (!foot_of(before, point[last], foot) || !(foot.at.squaredNorm() < best2)) continue;
      best2 = foot.at.squaredNorm();
      nearest_ = foot.at;
      best_set = before | 1U << last;
      for (int k = 0; k < 4; ++k) weight[k] = foot.weight[k];
    }
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      if (!(best_set >> k & 1U)) continue;
      point[kept] = point[k];
      tag[kept++] = tag[k];
    }
    count = kept;
    return nearest_;
  }

 private:
  struct Foot {
    Vec3 at;
    double weight[4];  // of the points of the set, in their order
    bool set(const Vec3& x, double b = 0.0, double c = 0.0, double d = 0.0) {
      at = x;
      weight[0] = 1.0 - b - c - d;
      weight[1] = b;
      weight[2] = c;
      weight[3] = d;
      return true;
    }
  };

  // The point nearest to the origin within the hull of the points in `before` and the last one, if
  // it lies inside of their affine hull's face: barycentric coordinates all positive.
  bool foot_of(unsigned before, const Vec3& last, Foot& foot) const {
    switch (before) {
      case 0:
        return foot.set(last);
      case 1:
        return on_line(point[0], last, foot);
      case 2:
        return on_line(point[1], last, foot);
      case 3:
        return on_plane(point[0], point[1], last, foot);
      case 4:
        return on_line(point[2], last, foot);
      case 5:
        return on_plane(point[0], point[2], last, foot);
      case 6:
        return on_plane(point[1], point[2], last, foot);
      default:
        return within(point[0], point[1], point[2], last, foot);
    }
  }

  static bool on_line(const Vec3& o, const Vec3& p, Foot& foot) {
    const Vec3 e = p - o;
    const double ee = e.squaredNorm(), s = -o.dot(e);
    return s > 0.0 && s < ee && foot.set(o + e * (s / ee), s / ee);
  }

  static bool on_plane(const Vec3& o, const Vec3& p, const Vec3& q, Foot& foot) {
    const Vec3 e1 = p - o, e2 = q - o, normal = e1.cross(e2);
    const double nn = normal.squaredNorm();
    if (!(nn > 0.0)) return false;
    const double u = normal.dot((-o).cross(e2)), v = normal.dot(e1.cross(-o));
    return u > 0.0 && v > 0.0 && u + v < nn &&
           foot.set(normal * (normal.dot(o) / nn), u / nn, v / nn);
  }

  static bool within(const Vec3& o, const Vec3& p, const Vec3& q, const Vec3& r, Foot& foot) {
    const Vec3 e1 = p - o, e2 = q - o, e3 = r - o;
    const double volume = e1.dot(e2.cross(e3)), sign = volume > 0.0 ? 1.0 : -1.0;
    const double u = sign * (-o).dot(e2.cross(e3)), v = sign * e1.dot((-o).cross(e3)),
                 w = sign * e1.dot(e2.cross(-o)), all = sign * volume;
    return u > 0.0 && v > 0.0 && w > 0.0 && u + v + w < all &&
           foot.set(Vec3::Zero(), u / all, v / all, w / all);
  }

  Vec3 nearest_ = Vec3::Constant(std::numeric_limits<double>::infinity());
};

}  // namespace mortise
