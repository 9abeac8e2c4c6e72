#pragma once

// Vectors of 32 bytes (GCC vector extension) and what the kernels do with them; the compiler splits
// them where registers are narrower. Comparisons give masks, `mask ? a : b` selects. Included
// inside an unnamed namespace, see kernels_impl.h.

using Floats = float __attribute__((vector_size(32)));
using Doubles = double __attribute__((vector_size(32)));
using FloatMask = int __attribute__((vector_size(32)));
using DoubleMask = long long __attribute__((vector_size(32)));

inline Floats all(float x) { return Floats{x, x, x, x, x, x, x, x}; }
inline Doubles all(double x) { return Doubles{x, x, x, x}; }
inline Floats load(const float* x) {
  Floats lanes;
  __builtin_memcpy(&lanes, x, sizeof lanes);
  return lanes;
}
inline Doubles load(const double* x) {
  Doubles lanes;
  __builtin_memcpy(&lanes, x, sizeof lanes);
  return lanes;
}
inline void store(Floats lanes, float* x) { __builtin_memcpy(x, &lanes, sizeof lanes); }
inline void store(Doubles lanes, double* x) { __builtin_memcpy(x, &lanes, sizeof lanes); }

template <class Lanes>
inline Lanes larger(Lanes a, Lanes b) {
  return a > b ? a : b;
}
template <class Lanes>
inline Lanes smaller(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Floats root(Floats x) {
  Floats y;
  for (int k = 0; k < 8; ++k) y[k] = __builtin_sqrtf(x[k]);
  return y;
}
inline Doubles root(Doubles x) {
  Doubles y;
  for (int k = 0; k < 4; ++k) y[k] = __builtin_sqrt(x[k]);
  return y;
}

// Least dt > 0 with gap - s dt - bend dt^2 / 2 = 0: 0 where the gap is not positive, the horizon
// where the parabola turns before, which is where its discriminant is below `least_square`. Of the
// two forms of the root each is used where nothing cancels.
template <class Lanes>
inline Lanes first_root(Lanes gap, Lanes s, Lanes bend, Lanes horizon, Lanes least_square) {
  const Lanes zero = {}, one = zero + 1.0F;
  const Lanes square = s * s + 2.0F * bend * larger(gap, zero);
  const Lanes disc = root(larger(square, zero));
  const auto closing = s >= zero;
  const Lanes numerator = closing ? 2.0F * larger(gap, zero) : disc - s;
  const Lanes denominator = closing ? s + disc : bend;
  // Beyond 2^20 ticks is never.
  const auto ever = (denominator > numerator * 0x1p-20F) & (square >= least_square);
  const Lanes dt = ever ? numerator / (ever ? denominator : one) : horizon;
  return gap > zero ? smaller(dt, horizon) : zero;
}
