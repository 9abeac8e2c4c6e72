// Included once by fit_sums_portable.cpp and fit_sums_wide.cpp, inside an unnamed namespace.
#include "common/geometry/kernels/lanes.h"

enum class Round { kCylinder, kCone, kSphere, kTorus };

// Point, axis, sizes.
constexpr int parameters_of(Round kind) {
  if (kind == Round::kSphere) return 4;
  if (kind == Round::kCylinder) return 5;
  return kind == Round::kCone ? 6 : 7;
}

// Residuals and their derivatives by the parameters, of one block.
struct Rows {
  Doubles residual;
  Doubles slope[kMostFitParameters];
};

inline Doubles inverse_or_zero(Doubles length) {
  const Doubles zero = {};
  return length > zero ? all(1.0) / length : zero;
}

template <Round kind>
inline Rows rows_at(const FitModel& m, const double* block) {
  Rows r = {};
  const Doubles dx = load(block) - all(m.p[0]), dy = load(block + 4) - all(m.p[1]),
                dz = load(block + 8) - all(m.p[2]);
  if constexpr (kind == Round::kSphere) {
    const Doubles length = root(dx * dx + dy * dy + dz * dz), inverse = inverse_or_zero(length);
    r.residual = length - all(m.size);
    r.slope[0] = -dx * inverse;
    r.slope[1] = -dy * inverse;
    r.slope[2] = -dz * inverse;
    r.slope[3] = all(-1.0);
    return r;
  }
  const Doubles along = dx * all(m.a[0]) + dy * all(m.a[1]) + dz * all(m.a[2]);
  const Doubles x = dx * all(m.u[0]) + dy * all(m.u[1]) + dz * all(m.u[2]);
  const Doubles y = dx * all(m.v[0]) + dy * all(m.v[1]) + dz * all(m.v[2]);
  const Doubles rho = root(x * x + y * y), inverse = inverse_or_zero(rho);
  const Doubles wu = x * inverse, wv = y * inverse, q = rho - all(m.size);
  Doubles shift = all(-1.0), tilt = -along;
  if constexpr (kind == Round::kCylinder) {
    r.residual = q;
    r.slope[4] = all(-1.0);
  } else if constexpr (kind == Round::kCone) {
    const Doubles cosine = all(m.cosine), sine = all(m.sine);
    shift = -cosine;
    tilt = -cosine * along - sine * rho;
    r.residual = q * cosine - along * sine;
    r.slope[4] = -cosine;
    r.slope[5] = -sine * q - cosine * along;
  } else {
    const Doubles tube = root(q * q + along * along), one = inverse_or_zero(tube);
    const Doubles to_rho = q * one, to_z = along * one;  // derivatives of the residual
    shift = -to_rho;
    tilt = to_z * rho - to_rho * along;
    r.residual = tube - all(m.other);
    r.slope[4] = -to_z;
    r.slope[5] = -to_rho;
    r.slope[6] = all(-1.0);
  }
  r.slope[0] = shift * wu;
  r.slope[1] = shift * wv;
  r.slope[2] = tilt * wu;
  r.slope[3] = tilt * wv;
  return r;
}

// Lanes have their own sums, which are added in one order: the result does not depend on how wide
// the registers of the machine are.
inline double sum_of(Doubles l) { return (l[0] + l[1]) + (l[2] + l[3]); }

template <Round kind>
void sum(const FitModel& m, const double* blocks, std::size_t count, double limit, FitPass& pass) {
  constexpr std::size_t kLookEvery = 8;  // blocks
  constexpr int n = parameters_of(kind);
  Doubles cost = {}, gradient[n] = {}, normal[n * (n + 1) / 2] = {};
  for (std::size_t b = 0; 4 * b < count; ++b) {
    Rows rows = rows_at<kind>(m, blocks + 12 * b);
    if (4 * (b + 1) > count) {
      const DoubleMask weighs =
          Doubles{0.0, 1.0, 2.0, 3.0} < all(static_cast<double>(count - 4 * b));
      const Doubles zero = {};
      rows.residual = weighs ? rows.residual : zero;
      for (int i = 0; i < n; ++i) rows.slope[i] = weighs ? rows.slope[i] : zero;
    }
    cost += rows.residual * rows.residual;
    if (b % kLookEvery == 0 && sum_of(cost) >= limit) break;
#pragma GCC unroll 7
    for (int i = 0; i < n; ++i) {
      gradient[i] += rows.residual * rows.slope[i];
#pragma GCC unroll 7
      for (int j = 0; j <= i; ++j) normal[i * (i + 1) / 2 + j] += rows.slope[i] * rows.slope[j];
    }
  }
  pass.cost = sum_of(cost);
  for (int i = 0; i < n; ++i) pass.gradient[i] = sum_of(gradient[i]);
  for (int i = 0; i < n * (n + 1) / 2; ++i) pass.normal[i] = sum_of(normal[i]);
}

constexpr FitKernels kKernels = {sum<Round::kCylinder>, sum<Round::kCone>, sum<Round::kSphere>,
                                 sum<Round::kTorus>};
