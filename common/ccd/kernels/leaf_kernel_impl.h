// Four triangles against four, a triangle a lane. Included by kernels_impl.h. No operation here may
// raise invalid, overflow or division by zero: divisors are chosen before dividing.
#include "common/geometry/kernels/lanes.h"

namespace leaves {

using Lanes = Doubles;
using Mask = DoubleMask;

constexpr double kNever = __builtin_inf();

inline Lanes clamp01(Lanes x) { return smaller(larger(x, all(0.0)), all(1.0)); }
inline double least(Lanes x) {
  const double a = x[0] < x[1] ? x[0] : x[1], b = x[2] < x[3] ? x[2] : x[3];
  return a < b ? a : b;
}
inline double most(Lanes x) { return -least(-x); }

struct Vec {
  Lanes x[3];
  Lanes& operator[](int c) { return x[c]; }
  const Lanes& operator[](int c) const { return x[c]; }
};

inline Vec every(const double* v) { return {{all(v[0]), all(v[1]), all(v[2])}}; }
inline Vec operator+(const Vec& a, const Vec& b) {
  return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
inline Vec operator-(const Vec& a, const Vec& b) {
  return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
inline Vec operator*(Lanes k, const Vec& a) { return {{k * a[0], k * a[1], k * a[2]}}; }
inline Lanes dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
inline Vec one_lane(const Vec& v, int i) { return {{all(v[0][i]), all(v[1][i]), all(v[2][i])}}; }

// Least dt > 0 with gap - s dt - bend dt^2 / 2 = 0: 0 where the gap is not positive, the horizon
// where the parabola turns before.
inline Lanes time_to_close(Lanes gap, Lanes s, Lanes bend, Lanes horizon) {
  return first_root(gap, s, bend, horizon, all(0.0));
}

// Where the corners of four triangles are and how they go: speed and acceleration by turning.
struct Side {
  Vec x[3], turn[3], bend[3];
  bool goes = false;
  Lanes bow, lift;
};

inline void set_turning(Side& side, const double* x_to_axis, const TurnTerms& terms,
                        bool backwards) {
  const Vec w = every(terms.w), to_axis = every(x_to_axis);
  side.goes = true;
  side.bow = all(terms.bow);
  side.lift = all(terms.lift);
  for (int k = 0; k < 3; ++k) {
    const Vec turn = cross(w, side.x[k] + to_axis);
    side.bend[k] = cross(w, turn);
    side.turn[k] = backwards ? cross(side.x[k] + to_axis, w) : turn;
  }
}

// Places, speeds and accelerations along n of the corners of one side. A side that does not go
// is its nearest corner.
struct Along {
  Lanes place[3], s[3], bend[3];
  int count;
};

inline Lanes most_of(const Lanes* x, int count) {
  return count == 1 ? x[0] : larger(larger(x[0], x[1]), x[2]);
}
inline Lanes least_of(const Lanes* x, int count) {
  return count == 1 ? x[0] : smaller(smaller(x[0], x[1]), x[2]);
}

// n points away from A (of_a) and towards B.
inline Along along(const Side& side, const Vec& n, bool of_a) {
  Along result;
  for (int k = 0; k < 3; ++k) result.place[k] = dot(n, side.x[k]);
  result.count = side.goes ? 3 : 1;
  if (!side.goes) {
    result.place[0] = of_a ? most_of(result.place, 3) : least_of(result.place, 3);
    result.s[0] = result.bend[0] = all(0.0);
    return result;
  }
  for (int k = 0; k < 3; ++k) {
    const Lanes speed = dot(n, side.turn[k]), acceleration = dot(n, side.bend[k]);
    const Lanes s = of_a ? speed : -speed, bend = of_a ? acceleration : -acceleration;
    result.s[k] = s;
    result.bend[k] = larger(bend, bend * side.bow) + side.lift * larger(-s, all(0.0));
  }
  return result;
}

struct Common {
  Vec v;
  Lanes taken, speed_slack, bend_slack, horizon;
};

// For how long every corner of a stays below every corner of b, each lane its own.
inline Lanes free_time(const Common& common, const Vec& n, const Along& a, const Along& b) {
  const Lanes v = dot(n, common.v) + common.speed_slack;
  Lanes dt = common.horizon;
  for (int k = 0; k < a.count; ++k)
    for (int m = 0; m < b.count; ++m)
      dt = smaller(dt, time_to_close(b.place[m] - a.place[k] - common.taken, v + a.s[k] + b.s[m],
                                     a.bend[k] + b.bend[m] + common.bend_slack, common.horizon));
  return dt;
}

// The lanes of one side together, as one corner that is as near, as fast and as bent as any.
inline Along together(const Along& x, bool of_a) {
  Along one;
  one.count = 1;
  one.place[0] = all(of_a ? most(most_of(x.place, x.count)) : least(least_of(x.place, x.count)));
  one.s[0] = all(most(most_of(x.s, x.count)));
  one.bend[0] = all(most(most_of(x.bend, x.count)));
  return one;
}

inline Side one_triangle(const Side& side, int i) {
  Side one;
  one.goes = side.goes;
  one.bow = side.bow;
  one.lift = side.lift;
  for (int k = 0; k < 3; ++k) {
    one.x[k] = one_lane(side.x[k], i);
    if (!side.goes) continue;
    one.turn[k] = one_lane(side.turn[k], i);
    one.bend[k] = one_lane(side.bend[k], i);
  }
  return one;
}

inline Lanes inverse(Lanes y) {
  const Mask safe = y > all(1e-280);  // the inverse of less may overflow
  return safe ? all(1.0) / (safe ? y : all(1.0)) : all(0.0);
}

// What the four triangles of a side know of themselves.
struct Faces {
  Vec edge[3], normal, inward[3];  // not unit
  Lanes length2[3], per_length2[3], area2, per_area2;
};

inline Faces faces_of(const Vec* x) {
  Faces f;
  for (int k = 0; k < 3; ++k) {
    f.edge[k] = x[k == 2 ? 0 : k + 1] - x[k];
    f.length2[k] = dot(f.edge[k], f.edge[k]);
    f.per_length2[k] = inverse(f.length2[k]);
  }
  f.normal = cross(f.edge[0], f.edge[1]);
  for (int k = 0; k < 3; ++k) f.inward[k] = cross(f.normal, f.edge[k]);
  f.area2 = dot(f.normal, f.normal);
  f.per_area2 = inverse(f.area2);
  return f;
}

inline Faces one_triangle(const Faces& f, int i) {
  Faces one;
  for (int k = 0; k < 3; ++k) {
    one.edge[k] = one_lane(f.edge[k], i);
    one.inward[k] = one_lane(f.inward[k], i);
    one.length2[k] = all(f.length2[k][i]);
    one.per_length2[k] = all(f.per_length2[k][i]);
  }
  one.normal = one_lane(f.normal, i);
  one.area2 = all(f.area2[i]);
  one.per_area2 = all(f.per_area2[i]);
  return one;
}

// The shortest way from triangle a (the same in every lane) to each of the triangles b. It only
// proposes a direction: whoever uses it measures the gap along it.
inline Vec shortest_way(const Vec* a, const Faces& fa, const Vec* b, const Faces& fb) {
  Lanes best = all(1e300);
  Vec way{{all(0.0), all(0.0), all(0.0)}};
  const auto take = [&](Lanes d2, const Vec& d, Mask allowed) {
    const Mask nearer = (d2 < best) & allowed;
    best = nearer ? d2 : best;
    for (int c = 0; c < 3; ++c) way[c] = nearer ? d[c] : way[c];
  };
  const Mask always = best == best;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec r = b[j] - a[i];
      const Lanes ab = dot(fa.edge[i], fb.edge[j]), ar = dot(fa.edge[i], r),
                  br = dot(fb.edge[j], r);
      const Lanes aa = fa.length2[i], bb = fb.length2[j];
      const Lanes sine2 = aa * bb - ab * ab;
      const Mask askew = sine2 > aa * bb * all(1e-14);
      Lanes s = askew ? clamp01((ar * bb - ab * br) / (askew ? sine2 : all(1.0))) : all(0.0);
      const Lanes t = clamp01((ab * s - br) * fb.per_length2[j]);
      s = clamp01((ab * t + ar) * fa.per_length2[i]);
      const Vec d = r + t * fb.edge[j] - s * fa.edge[i];
      take(dot(d, d), d, always);
    }
  // Corners over the inside of a face.
  const auto over = [&](const Vec& x, const Vec* t, const Faces& f) {
    Mask in = f.area2 > all(0.0);
    for (int k = 0; k < 3; ++k) in &= dot(f.inward[k], x - t[k]) >= all(0.0);
    return in;
  };
  for (int k = 0; k < 3; ++k) {
    const Lanes height_b = dot(b[k] - a[0], fa.normal), height_a = dot(a[k] - b[0], fb.normal);
    take(height_b * height_b * fa.per_area2, height_b * fa.per_area2 * fa.normal,
         over(b[k], a, fa));
    take(height_a * height_a * fb.per_area2, -height_a * fb.per_area2 * fb.normal,
         over(a[k], b, fb));
  }
  return way;
}

inline Vec unit(const Vec& v) { return inverse(root(dot(v, v))) * v; }

// The sum of the normals, each as long as its area, in every lane.
inline Vec normal_of_leaf(const Vec* x, int count) {
  const Vec normal = cross(x[1] - x[0], x[2] - x[0]);
  Vec sum = one_lane(normal, 0);
  for (int i = 1; i < count; ++i) sum = sum + one_lane(normal, i);
  return unit(sum);
}

// Triangles that share the corner or the edge that decides are not looked at for the last bits.
constexpr double kGoodEnough = 0.999;

// The sides of a pair of leaves, one of which goes where the other is seen from.
struct Sides {
  Side a, b;
  Vec normal_a, normal_b;  // of each leaf, towards the other
  Common common;
};

inline Sides sides_of(const LeafFrame& f, const LeafCorners& corners_a,
                      const LeafCorners& corners_b) {
  Sides sides;
  Side &a = sides.a, &b = sides.b;
  for (int k = 0; k < 3; ++k) {
    const Vec u{{load(corners_a.at[k][0]), load(corners_a.at[k][1]), load(corners_a.at[k][2])}};
    for (int c = 0; c < 3; ++c) {
      a.x[k][c] =
          all(f.r[c][0]) * u[0] + all(f.r[c][1]) * u[1] + all(f.r[c][2]) * u[2] + all(f.p[c]);
      b.x[k][c] = load(corners_b.at[k][c]);
    }
  }
  sides.normal_a = normal_of_leaf(a.x, corners_a.count);
  sides.normal_b = all(-1.0) * normal_of_leaf(b.x, corners_b.count);
  sides.common = {every(f.v), all(f.taken_mm), all(f.speed_slack), all(f.bend_slack),
                  all(f.horizon)};
  if (f.a.turns) {
    double a_to_axis[3];
    for (int c = 0; c < 3; ++c) a_to_axis[c] = f.a.arm[c] - f.p[c];
    // n . acceleration of the first corner: does A turn away from what lies before it?
    const Vec w = every(f.a.w);
    const bool towards =
        dot(sides.normal_a, cross(w, cross(w, a.x[0] + every(a_to_axis))))[0] > 0.0;
    if (towards && !f.b.turns) {
      set_turning(b, a_to_axis, f.a, true);
      sides.common.bend_slack += all(f.sweep);
    } else {
      set_turning(a, a_to_axis, f.a, false);
    }
  }
  if (f.b.turns) set_turning(b, f.b.arm, f.b, false);
  return sides;
}

// 1. Along one direction for all, the normals of the leaves.
// 2. As long as that is not enough: the row that is free for the shortest time, each pair along the
//    shortest way between its triangles, and the way that decides for all.
class PairTimes {
 public:
  PairTimes(const Sides& sides, const LeafFrame& frame, int count_a, int count_b)
      : s_(sides), suspect_mm_(all(frame.suspect_mm)), count_a_(count_a), count_b_(count_b) {
    for (Lanes& dt : dt_) dt = all(0.0);
  }

  // Along one direction for all: each triangle of the side that goes against all of the other,
  // which then is one corner. Least of all pairs.
  double free_along(const Vec& n) {
    const Along of_a = along(s_.a, n, true), of_b = along(s_.b, n, false);
    if (s_.b.goes && !s_.a.goes) {
      const Lanes dt = free_time(s_.common, n, together(of_a, true), of_b);
      for (Lanes& row : dt_) row = larger(row, dt);
      return least(dt);
    }
    const Lanes dt = free_time(s_.common, n, of_a, together(of_b, false));
    for (int i = 0; i < 4; ++i)
      if (!exact_[i]) dt_[i] = larger(dt_[i], all(dt[i]));
    return least(dt);
  }

  unsigned refine(double enough) {
    const Faces faces_a = faces_of(s_.a.x), faces_b = faces_of(s_.b.x);
    unsigned suspects = 0;
    double best = enough;
    for (int row = earliest_row(best); row >= 0; row = earliest_row(best))
      suspects |= look_at(row, faces_a, faces_b, best);
    return suspects;
  }

  double least_of_all() const {
    double dt = kNever;
    for (int i = 0; i < count_a_; ++i) {
      const double dt_row = least(dt_[i]);
      if (dt_row < dt) dt = dt_row;
    }
    return dt;
  }

 private:
  // -1: none is worth a look.
  int earliest_row(double best) const {
    int row = -1;
    double earliest = kGoodEnough * best;
    for (int i = 0; i < count_a_; ++i) {
      if (exact_[i]) continue;
      const double dt = least(dt_[i]);
      if (dt < earliest || (dt <= 0.0 && row < 0)) {
        earliest = dt;
        row = i;
      }
    }
    return row;
  }

  // The suspects of the row. `best`: the shortest time of any row that was looked at.
  unsigned look_at(int row, const Faces& faces_a, const Faces& faces_b, double& best) {
    const Side one = one_triangle(s_.a, row);
    const Faces faces_one = one_triangle(faces_a, row);
    const Vec n = unit(shortest_way(one.x, faces_one, s_.b.x, faces_b));
    const Along of_a = along(one, n, true), of_b = along(s_.b, n, false);
    const Lanes gap = least_of(of_b.place, of_b.count) - most_of(of_a.place, of_a.count);
    const Lanes dt = larger(dt_[row], free_time(s_.common, n, of_a, of_b));
    const Mask suspect = (gap <= suspect_mm_) | (dt <= all(0.0));
    unsigned suspects = 0;
    int decides = 0;
    for (int j = 0; j < count_b_; ++j) {
      if (suspect[j]) suspects |= 1U << (4 * row + j);
      if (dt[j] < dt[decides]) decides = j;
    }
    dt_[row] = suspect ? all(kNever) : dt;
    exact_[row] = true;
    const double dt_row = least(dt_[row]);
    if (dt_row < best) best = dt_row;
    if (suspect[decides] == 0) free_along(one_lane(n, decides));
    return suspects;
  }

  const Sides& s_;
  const Lanes suspect_mm_;
  const int count_a_, count_b_;
  Lanes dt_[4];  // row i: triangle i of A against the four of B
  bool exact_[4] = {false, false, false, false};
};

LeafAnswer advance(const LeafFrame& frame, const LeafCorners& a, const LeafCorners& b,
                   double enough) {
  const Sides sides = sides_of(frame, a, b);
  PairTimes pairs(sides, frame, a.count, b.count);
  LeafAnswer answer;
  const Vec* normals[2] = {&sides.normal_a, &sides.normal_b};
  for (const Vec* n : normals) {
    const double whole = pairs.free_along(*n);
    if (whole > 0.0 && whole >= enough) {
      answer.dt = whole;
      return answer;
    }
  }
  answer.suspects = pairs.refine(enough);
  answer.dt = pairs.least_of_all();
  return answer;
}

}  // namespace leaves
