// Eight pairs of boxes, a pair a lane. Included by kernels_impl.h.
#include "common/geometry/kernels/lanes.h"

namespace boxes {

using Lanes = Floats;
using Mask = FloatMask;

inline Lanes magnitude(Lanes x) { return (Lanes)((Mask)x & 0x7fffffff); }

struct Boxes {
  Lanes center[3], half[3];
};

inline Boxes boxes_of(const EightBoxes& eight) {
  Boxes boxes;
  for (int c = 0; c < 3; ++c) {
    boxes.center[c] = load(eight.center[c]);
    boxes.half[c] = load(eight.half[c]);
  }
  return boxes;
}

inline Boxes boxes_of(const OneBox& box) {
  Boxes boxes;
  for (int c = 0; c < 3; ++c) {
    boxes.center[c] = all(box.center[c]);
    boxes.half[c] = all(box.half[c]);
  }
  return boxes;
}

inline Lanes dot(const float* a, const Lanes* b) {
  return all(a[0]) * b[0] + all(a[1]) * b[1] + all(a[2]) * b[2];
}
inline Lanes dot(const Lanes* a, const Lanes* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline void cross(const float* w, const Lanes* x, Lanes* out) {
  out[0] = all(w[1]) * x[2] - all(w[2]) * x[1];
  out[1] = all(w[2]) * x[0] - all(w[0]) * x[2];
  out[2] = all(w[0]) * x[1] - all(w[1]) * x[0];
}
inline void cross(const Lanes* n, const float* w, Lanes* out) {
  out[0] = n[1] * all(w[2]) - n[2] * all(w[1]);
  out[1] = n[2] * all(w[0]) - n[0] * all(w[2]);
  out[2] = n[0] * all(w[1]) - n[1] * all(w[0]);
}

constexpr float kNever = __builtin_inff();

// The relative errors of the float operations of one step add up to less than 2e-6 (thirty of
// 6e-8).
constexpr float kShorter = 1.0F - 4e-6F;

// Least dt > 0 with gap - s dt - bend dt^2 / 2 = 0. A discriminant that is lost in rounding proves
// nothing.
inline Lanes time_to_close(Lanes gap, Lanes s, Lanes bend, Lanes horizon) {
  return first_root(gap, s, bend, horizon, all(-8e-6F) * s * s);
}

// Upper bounds of the speed and the acceleration of any point of a box along a direction (see
// TurnTerms).
struct Going {
  Lanes s, bend;
};

// s and bend of the centre, and by how much a corner exceeds either.
inline void add(Going& going, Lanes s, Lanes reach, Lanes bend, Lanes bend_reach,
                const BoxTurn& turn) {
  const Lanes largest = bend + bend_reach;
  going.s += s + reach;
  going.bend +=
      larger(largest, largest * all(turn.bow)) + all(turn.lift) * larger(reach - s, all(0.0F));
}

inline Lanes dot_magnitude(const Lanes* a, const Lanes* half) {
  return magnitude(a[0]) * half[0] + magnitude(a[1]) * half[1] + magnitude(a[2]) * half[2];
}
inline Lanes dot_magnitude(float x, float y, float z, const Lanes* half) {
  return all(__builtin_fabsf(x)) * half[0] + all(__builtin_fabsf(y)) * half[1] +
         all(__builtin_fabsf(z)) * half[2];
}

// Speed w x e and acceleration w x (w x e) of the centres of eight boxes by turning.
struct Turned {
  Lanes speed[3], bend[3];
  Turned(const Lanes* from_origin, const BoxTurn& turn, bool turns) {
    if (!turns) return;
    const Lanes e[3] = {from_origin[0] + all(turn.arm[0]), from_origin[1] + all(turn.arm[1]),
                        from_origin[2] + all(turn.arm[2])};
    cross(turn.w, e, speed);
    cross(turn.w, speed, bend);
  }
  Lanes any_bend(const Lanes* half, const BoxTurn& turn) const {
    return root(dot(speed, speed)) + all(turn.speed) * root(dot(half, half));
  }
};

// n . (w x x) = (n x w) . x and n . (w x (w x x)) = ((n . w) w - |w|^2 n) . x: how far the corners
// of boxes reach along axis k of B and along axis k of A, in the axes of their own body.
inline Lanes reach_b_axis(const BoxTurn& t, int k, bool of_a, const Lanes* half) {
  if (of_a) return dot_magnitude(t.r_w[0][k], t.r_w[1][k], t.r_w[2][k], half);
  return k == 0   ? dot_magnitude(0.0F, t.w[2], t.w[1], half)
         : k == 1 ? dot_magnitude(t.w[2], 0.0F, t.w[0], half)
                  : dot_magnitude(t.w[1], t.w[0], 0.0F, half);
}
inline Lanes reach_a_axis(const BoxTurn& t, int k, bool of_a, const Lanes* half) {
  if (!of_a) return dot_magnitude(t.r_w[k][0], t.r_w[k][1], t.r_w[k][2], half);
  return k == 0   ? dot_magnitude(0.0F, t.w_A[2], t.w_A[1], half)
         : k == 1 ? dot_magnitude(t.w_A[2], 0.0F, t.w_A[0], half)
                  : dot_magnitude(t.w_A[1], t.w_A[0], 0.0F, half);
}
inline Lanes bend_reach(float n_w, const float* w, float speed2, const float* n,
                        const Lanes* half) {
  return dot_magnitude(n_w * w[0] - speed2 * n[0], n_w * w[1] - speed2 * n[1],
                       n_w * w[2] - speed2 * n[2], half);
}

// The axes of a box.
constexpr float kUnit[3][3] = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};

// For how long eight pairs of boxes stay apart: the longest time that one of seven directions
// proves.
template <bool kTurnsA, bool kTurnsB>
class Advance {
 public:
  Advance(const BoxFrame& frame, const Boxes& boxes_a, const Boxes& boxes_b)
      : f(frame),
        a(boxes_a),
        b(boxes_b),
        u{dot(f.r[0], a.center), dot(f.r[1], a.center), dot(f.r[2], a.center)},
        turned_a(u, f.a, kTurnsA),
        turned_b(b.center, f.b, kTurnsB) {
    for (int k = 0; k < 3; ++k) {
      d[k] = b.center[k] - (u[k] + all(f.p[k]));
      gap[k] = magnitude(d[k]) - b.half[k] - dot(f.abs_r[k], a.half) - all(f.gap_allowance);
    }
  }

  void run(float* out) {
    between_boxes();
    for (int k = 0; k < 3 && !done(); ++k) along_axis_of_b(k);
    for (int k = 0; k < 3 && !done(); ++k) along_axis_of_a(k);
    store(best * all(kShorter), out);
  }

 private:
  // Nothing is gained beyond the end of the tick.
  bool done() const {
    const Mask still = best * all(kShorter) < all(f.rest);
    return (still[0] | still[1] | still[2] | still[3] | still[4] | still[5] | still[6] |
            still[7]) == 0;
  }

  void take(Lanes along_gap, const Going& going) {
    best = larger(best, time_to_close(along_gap, going.s, going.bend, all(f.horizon)));
  }

  // The direction from box to box, each lane its own. Each gap has paid the whole allowance.
  void between_boxes() {
    const Lanes zero = all(0.0F);
    const Lanes apart[3] = {larger(gap[0], zero), larger(gap[1], zero), larger(gap[2], zero)};
    const Lanes length = root(dot(apart, apart));
    const Lanes inverse = all(1.0F) / larger(length, all(1e-30F));
    Lanes n[3];
    for (int k = 0; k < 3; ++k) n[k] = (d[k] > zero ? apart[k] : -apart[k]) * inverse;
    Going going{dot(f.v, n) + all(f.speed_allowance), all(f.bend_allowance)};
    // Whichever way a body will have turned: |n x w| |w x e| (README, section 2).
    Lanes largest_bend = all(f.bend_allowance);
    if constexpr (kTurnsA) {
      Lanes m[3], g[3], m_A[3], g_A[3];
      cross(n, f.a.w, m);
      cross(m, f.a.w, g);
      for (int j = 0; j < 3; ++j) {
        const float axis[3] = {f.r[0][j], f.r[1][j], f.r[2][j]};
        m_A[j] = dot(axis, m);
        g_A[j] = dot(axis, g);
      }
      add(going, dot(n, turned_a.speed), dot_magnitude(m_A, a.half), dot(n, turned_a.bend),
          dot_magnitude(g_A, a.half), f.a);
      largest_bend += root(dot(m, m)) * turned_a.any_bend(a.half, f.a);
    }
    if constexpr (kTurnsB) {
      Lanes m[3], g[3];
      cross(n, f.b.w, m);
      cross(m, f.b.w, g);
      add(going, -dot(n, turned_b.speed), dot_magnitude(m, b.half), -dot(n, turned_b.bend),
          dot_magnitude(g, b.half), f.b);
      largest_bend += root(dot(m, m)) * turned_b.any_bend(b.half, f.b);
    }
    // Far from each other, beyond the horizon of what bends away.
    if ((kTurnsA || kTurnsB) && f.horizon < 1.0F)
      best = larger(best, time_to_close(length, going.s, largest_bend, all(kNever)));
    take(length, going);
  }

  void along_axis_of_b(int k) {
    const Mask forward = d[k] > all(0.0F);
    Going going = along(forward, f.v[k]);
    if constexpr (kTurnsA)
      add(going, forward ? turned_a.speed[k] : -turned_a.speed[k],
          reach_b_axis(f.a, k, true, a.half), forward ? turned_a.bend[k] : -turned_a.bend[k],
          bend_reach(f.a.w[k], f.a.w_A, f.a.speed2, f.r[k], a.half), f.a);
    if constexpr (kTurnsB)
      add(going, forward ? -turned_b.speed[k] : turned_b.speed[k],
          reach_b_axis(f.b, k, false, b.half), forward ? -turned_b.bend[k] : turned_b.bend[k],
          bend_reach(f.b.w[k], f.b.w, f.b.speed2, kUnit[k], b.half), f.b);
    take(gap[k], going);
  }

  void along_axis_of_a(int k) {
    const float n[3] = {f.r[0][k], f.r[1][k], f.r[2][k]};
    const Lanes apart = dot(n, d);
    const Lanes extent_b = all(f.abs_r[0][k]) * b.half[0] + all(f.abs_r[1][k]) * b.half[1] +
                           all(f.abs_r[2][k]) * b.half[2];
    const Mask forward = apart > all(0.0F);
    Going going = along(forward, f.v_A[k]);
    if constexpr (kTurnsA) {
      const Lanes s = dot(n, turned_a.speed), bend = dot(n, turned_a.bend);
      add(going, forward ? s : -s, reach_a_axis(f.a, k, true, a.half), forward ? bend : -bend,
          bend_reach(f.a.w_A[k], f.a.w_A, f.a.speed2, kUnit[k], a.half), f.a);
    }
    if constexpr (kTurnsB) {
      const Lanes s = dot(n, turned_b.speed), bend = dot(n, turned_b.bend);
      add(going, forward ? -s : s, reach_a_axis(f.b, k, false, b.half), forward ? -bend : bend,
          bend_reach(f.b.w_A[k], f.b.w, f.b.speed2, n, b.half), f.b);
    }
    take(magnitude(apart) - a.half[k] - extent_b - all(f.gap_allowance), going);
  }

  // An axis along which the bodies close by v, or by -v where it points the other way.
  Going along(Mask forward, float v) const {
    return {(forward ? all(v) : all(-v)) + all(f.speed_allowance), all(f.bend_allowance)};
  }

  const BoxFrame& f;
  const Boxes &a, &b;
  const Lanes u[3];  // centres of A's boxes, from the origin of A's boxes
  const Turned turned_a, turned_b;
  Lanes d[3], gap[3];  // from A to B; along the axes of B, less the allowance
  Lanes best = all(0.0F);
};

inline void advance_any(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  if (f.b.turns) {
    if (f.a.turns)
      Advance<true, true>(f, a, b).run(out);
    else
      Advance<false, true>(f, a, b).run(out);
  } else {
    if (f.a.turns)
      Advance<true, false>(f, a, b).run(out);
    else
      Advance<false, false>(f, a, b).run(out);
  }
}

// Gaps of the boxes along the axes of B and of A; below zero where they
// overlap.
struct Gaps {
  Lanes d[3];  // from centre to centre
  Lanes b[3], a[3];
};

inline Gaps gaps_of(const BoxFrame& f, const Boxes& a, const Boxes& b) {
  Gaps gaps;
  Lanes(&d)[3] = gaps.d;
  for (int i = 0; i < 3; ++i) {
    d[i] = b.center[i] - (dot(f.r[i], a.center) + all(f.p[i]));
    gaps.b[i] = magnitude(d[i]) - b.half[i] - dot(f.abs_r[i], a.half);
  }
  for (int k = 0; k < 3; ++k) {
    const Lanes along = all(f.r[0][k]) * d[0] + all(f.r[1][k]) * d[1] + all(f.r[2][k]) * d[2];
    const Lanes extent_b = all(f.abs_r[0][k]) * b.half[0] + all(f.abs_r[1][k]) * b.half[1] +
                           all(f.abs_r[2][k]) * b.half[2];
    gaps.a[k] = magnitude(along) - a.half[k] - extent_b;
  }
  return gaps;
}

// The largest gap along an axis across one of B and one of A; such an axis is
// no longer than 1, so that the gap along it is no more than the distance.
inline Lanes across_both(const BoxFrame& f, const Boxes& a, const Boxes& b, const Lanes* d) {
  Lanes most = all(-1e30F);
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const Lanes along = d[i2] * all(f.r[i1][j]) - d[i1] * all(f.r[i2][j]);
      const Lanes extent = b.half[i1] * all(f.abs_r[i2][j]) + b.half[i2] * all(f.abs_r[i1][j]) +
                           a.half[j1] * all(f.abs_r[i][j2]) + a.half[j2] * all(f.abs_r[i][j1]);
      most = larger(most, magnitude(along) - extent);
    }
  }
  return most;
}

// Distance of the boxes in either frame of axes, or across both, whichever is
// larger.
inline void lower_bound(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  const Lanes zero = all(0.0F);
  const Gaps gaps = gaps_of(f, a, b);
  Lanes square_b = zero, square_a = zero;
  for (int k = 0; k < 3; ++k) {
    const Lanes gap_b = larger(gaps.b[k], zero), gap_a = larger(gaps.a[k], zero);
    square_b += gap_b * gap_b;
    square_a += gap_a * gap_a;
  }
  store(larger(root(larger(square_a, square_b)), across_both(f, a, b, gaps.d)) * all(kShorter) -
            all(f.gap_allowance),
        out);
}

inline void apart(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  const Gaps gaps = gaps_of(f, a, b);
  Lanes most = larger(gaps.b[0], gaps.a[0]);
  for (int k = 1; k < 3; ++k) most = larger(most, larger(gaps.b[k], gaps.a[k]));
  const Lanes across = across_both(f, a, b, gaps.d);
  most = across > all(0.0F) ? larger(most, across) : most;
  store(most * all(kShorter) - all(f.gap_allowance), out);
}

void advance_a(const BoxFrame& f, const EightBoxes& a, const OneBox& b, float* out) {
  advance_any(f, boxes_of(a), boxes_of(b), out);
}
void advance_b(const BoxFrame& f, const OneBox& a, const EightBoxes& b, float* out) {
  advance_any(f, boxes_of(a), boxes_of(b), out);
}
void lower_a(const BoxFrame& f, const EightBoxes& a, const OneBox& b, float* out) {
  lower_bound(f, boxes_of(a), boxes_of(b), out);
}
void lower_b(const BoxFrame& f, const OneBox& a, const EightBoxes& b, float* out) {
  lower_bound(f, boxes_of(a), boxes_of(b), out);
}
void apart_a(const BoxFrame& f, const EightBoxes& a, const OneBox& b, float* out) {
  apart(f, boxes_of(a), boxes_of(b), out);
}
void apart_b(const BoxFrame& f, const OneBox& a, const EightBoxes& b, float* out) {
  apart(f, boxes_of(a), boxes_of(b), out);
}

constexpr BoxKernels kKernels{advance_a, advance_b, lower_a, lower_b, apart_a, apart_b};

}  // namespace boxes
