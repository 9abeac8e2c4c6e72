// Included once by every box_advance_<instructions>.cpp, inside an unnamed namespace.
// Eight floats a vector (GCC vector extension); the compiler splits them where registers are
// narrower. Comparisons give masks, `mask ? a : b` selects.

typedef float Lanes __attribute__((vector_size(32)));
typedef int Mask __attribute__((vector_size(32)));

inline Lanes all(float x) { return Lanes{x, x, x, x, x, x, x, x}; }
inline Lanes load(const float* x) {
  Lanes lanes;
  __builtin_memcpy(&lanes, x, sizeof lanes);
  return lanes;
}
inline Lanes magnitude(Lanes x) { return (Lanes)((Mask)x & 0x7fffffff); }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes root(Lanes x) {
  Lanes y;
  for (int k = 0; k < 8; ++k) y[k] = __builtin_sqrtf(x[k]);
  return y;
}

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

// |axis x r|, the distance from the axis of rotation. By the cross product: the difference of
// squares would lose half the digits near the axis.
inline Lanes distance_from_axis(const float* axis, const Lanes* r) {
  const Lanes x = all(axis[1]) * r[2] - all(axis[2]) * r[1];
  const Lanes y = all(axis[2]) * r[0] - all(axis[0]) * r[2];
  const Lanes z = all(axis[0]) * r[1] - all(axis[1]) * r[0];
  return root(x * x + y * y + z * z);
}

// The relative errors of the float operations of one step add up to less than 2e-6 (thirty of
// 6e-8).
constexpr float kShorter = 1.0F - 4e-6F;
constexpr float kLonger = 1.0F + 4e-6F;

// Least dt > 0 with gap - s dt - bend dt^2 / 2 = 0; 0 where the gap is not positive. Of the two
// forms of the root each is used where nothing cancels.
inline Lanes time_to_close(Lanes gap, Lanes s, Lanes bend) {
  const Lanes zero = all(0.0F);
  const Lanes disc = root(s * s + all(2.0F) * bend * larger(gap, zero));
  const Mask closing = s >= zero;
  const Lanes numerator = closing ? all(2.0F) * gap : disc - s;
  const Lanes denominator = closing ? s + disc : bend;
  return gap > zero ? numerator / larger(denominator, all(1e-30F)) : zero;
}

template <bool kTurnsA, bool kTurnsB>
inline void advance(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  const Lanes zero = all(0.0F);
  Lanes u[3], d[3], extent_a[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = dot(f.r[i], a.center);
    d[i] = b.center[i] - (u[i] + all(f.p[i]));
    extent_a[i] = dot(f.abs_r[i], a.half);
  }
  Lanes rho_a = zero, rho_b = zero;
  if constexpr (kTurnsA) {
    const Lanes r[3] = {u[0] + all(f.arm_a[0]), u[1] + all(f.arm_a[1]), u[2] + all(f.arm_a[2])};
    rho_a = distance_from_axis(f.axis_a, r) + root(dot(a.half, a.half)) + all(f.arm_allowance);
  }
  if constexpr (kTurnsB) {
    const Lanes r[3] = {b.center[0] + all(f.arm_b[0]), b.center[1] + all(f.arm_b[1]),
                        b.center[2] + all(f.arm_b[2])};
    rho_b = distance_from_axis(f.axis_b, r) + root(dot(b.half, b.half)) + all(f.arm_allowance);
  }
  Lanes best = zero;
  Lanes gap[3];
  const auto try_direction = [&](const DirectionTerms& n, Lanes along, Lanes free_gap) {
    Lanes s = all(n.v), reach = all(f.speed_allowance), bend = zero;
    if constexpr (kTurnsA) {
      s += dot(n.turn_a, u);
      reach += dot(n.reach_a, a.half);
      bend += all(n.bend_a) * rho_a;
    }
    if constexpr (kTurnsB) {
      s -= dot(n.turn_b, b.center);
      reach += all(__builtin_fabsf(n.turn_b[0])) * b.half[0] +
               all(__builtin_fabsf(n.turn_b[1])) * b.half[1] +
               all(__builtin_fabsf(n.turn_b[2])) * b.half[2];
      bend += all(n.bend_b) * rho_b;
    }
    s = (along > zero ? s : -s) + reach;
    best = larger(best, time_to_close(free_gap, s, bend * all(kLonger)));
  };
  for (int k = 0; k < 3; ++k) {
    const Lanes free_gap = magnitude(d[k]) - b.half[k] - extent_a[k] - all(f.gap_allowance);
    gap[k] = larger(free_gap, zero);
    try_direction(f.direction[k], d[k], free_gap);
  }
  for (int k = 0; k < 3; ++k) {
    const DirectionTerms& n = f.direction[3 + k];
    const Lanes along = dot(n.n, d);
    const Lanes extent_b = all(f.abs_r[0][k]) * b.half[0] + all(f.abs_r[1][k]) * b.half[1] +
                           all(f.abs_r[2][k]) * b.half[2];
    try_direction(n, along, magnitude(along) - a.half[k] - extent_b - all(f.gap_allowance));
  }
  // The direction from box to box, each lane its own. Each gap above has paid the whole allowance.
  {
    const Lanes length = root(dot(gap, gap));
    const Lanes inverse = all(1.0F) / larger(length, all(1e-30F));
    Lanes n[3];
    for (int k = 0; k < 3; ++k) n[k] = (d[k] > zero ? gap[k] : -gap[k]) * inverse;
    Lanes s = dot(f.v, n) + all(f.speed_allowance), bend = zero;
    if constexpr (kTurnsA) {
      const Lanes m[3] = {n[1] * all(f.w_a[2]) - n[2] * all(f.w_a[1]),
                          n[2] * all(f.w_a[0]) - n[0] * all(f.w_a[2]),
                          n[0] * all(f.w_a[1]) - n[1] * all(f.w_a[0])};
      s += dot(m, u);
      for (int j = 0; j < 3; ++j)
        s += magnitude(m[0] * all(f.r[0][j]) + m[1] * all(f.r[1][j]) + m[2] * all(f.r[2][j])) *
             a.half[j];
      bend += root(dot(m, m)) * all(f.speed_a) * rho_a;
    }
    if constexpr (kTurnsB) {
      const Lanes m[3] = {n[1] * all(f.w_b[2]) - n[2] * all(f.w_b[1]),
                          n[2] * all(f.w_b[0]) - n[0] * all(f.w_b[2]),
                          n[0] * all(f.w_b[1]) - n[1] * all(f.w_b[0])};
      s -= dot(m, b.center);
      for (int j = 0; j < 3; ++j) s += magnitude(m[j]) * b.half[j];
      bend += root(dot(m, m)) * all(f.speed_b) * rho_b;
    }
    best = larger(best, time_to_close(length, s, bend * all(kLonger)));
  }
  best *= all(kShorter);
  __builtin_memcpy(out, &best, sizeof best);
}

inline void advance_any(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  if (f.turns_b) {
    if (f.turns_a)
      advance<true, true>(f, a, b, out);
    else
      advance<false, true>(f, a, b, out);
  } else {
    if (f.turns_a)
      advance<true, false>(f, a, b, out);
    else
      advance<false, false>(f, a, b, out);
  }
}

// Distance of the boxes in either frame of axes, whichever is larger.
inline void lower_bound(const BoxFrame& f, const Boxes& a, const Boxes& b, float* out) {
  const Lanes zero = all(0.0F);
  Lanes d[3], square_b = zero, square_a = zero;
  for (int i = 0; i < 3; ++i) {
    d[i] = b.center[i] - (dot(f.r[i], a.center) + all(f.p[i]));
    const Lanes gap = larger(magnitude(d[i]) - b.half[i] - dot(f.abs_r[i], a.half), zero);
    square_b += gap * gap;
  }
  for (int k = 0; k < 3; ++k) {
    const Lanes along = all(f.r[0][k]) * d[0] + all(f.r[1][k]) * d[1] + all(f.r[2][k]) * d[2];
    const Lanes extent_b = all(f.abs_r[0][k]) * b.half[0] + all(f.abs_r[1][k]) * b.half[1] +
                           all(f.abs_r[2][k]) * b.half[2];
    const Lanes gap = larger(magnitude(along) - a.half[k] - extent_b, zero);
    square_a += gap * gap;
  }
  const Lanes lower = root(larger(square_a, square_b)) * all(kShorter) - all(f.gap_allowance);
  __builtin_memcpy(out, &lower, sizeof lower);
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

constexpr BoxKernels kKernels{advance_a, advance_b, lower_a, lower_b};
