// Included once by nearest_portable.cpp and nearest_wide.cpp, inside an unnamed namespace.
#include "common/geometry/kernels/lanes.h"

// Rounding of squares and sums is below 1e-6 of them.
unsigned boxes(const BoxPoint& point, const float (*center)[8], const float (*half)[8],
               float limit2, float* distance2) {
  const Floats zero = {}, most = all(__FLT_MAX__);
  Floats sum = {};
  for (int c = 0; c < 3; ++c) {
    const Floats from = all(point.x[c]) - load(center[c]);
    const Floats gap = larger(from, -from) - load(half[c]) - all(point.slack_mm);
    const Floats outside = larger(gap, zero);
    sum += outside * outside;
  }
  const Floats lower = smaller(sum * all(1.0F - 1e-6F), most);
  store(lower, distance2);
  const FloatMask near = lower <= all(limit2);
#ifdef __AVX2__
  return static_cast<unsigned>(__builtin_ia32_movmskps256((Floats)near));
#else
  unsigned mask = 0;
  for (int k = 0; k < 8; ++k) mask |= near[k] != 0 ? 1U << k : 0U;
  return mask;
#endif
}

struct Vec {
  Doubles x, y, z;
};
inline Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Doubles dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The distance is that from the plane where the foot is inside, else the least of those from the
// edges. The normal of a triangle of aspect A is turned by rounding, by some 1e-15 A: up to 3e7
// these parts of the square and of that of the corners cover it. A triangle that is thinner is less
// than a 1e7th of its edges wide, and the edges alone are no farther away than that.
constexpr double kOfSquare = 3e-6, kOfCorners = 1e-9;

void triangles(const TrianglePoint& from, const double* corners, int count, double* distance2) {
  const double* point = from.x;
  const Vec x{all(point[0]), all(point[1]), all(point[2])};
  const double* t[4];
  for (int i = 0; i < 4; ++i) t[i] = corners + 9 * (i < count ? i : 0);
  Vec p[3];
  for (int k = 0; k < 3; ++k) {
    const int c = 3 * k;
    p[k] = {Doubles{t[0][c], t[1][c], t[2][c], t[3][c]},
            Doubles{t[0][c + 1], t[1][c + 1], t[2][c + 1], t[3][c + 1]},
            Doubles{t[0][c + 2], t[1][c + 2], t[2][c + 2], t[3][c + 2]}};
  }
  const Doubles zero = {}, one = all(1.0), tiny = all(1e-280);
  const Vec to[3] = {x - p[0], x - p[1], x - p[2]};
  const Vec edge[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec normal = cross(edge[0], edge[1]);
  Doubles least = all(1e300), scale = zero;
  DoubleMask inside = zero == zero;
  for (int k = 0; k < 3; ++k) {
    const Doubles along = dot(edge[k], to[k]), length2 = dot(edge[k], edge[k]);
    const Doubles s = smaller(larger(along / larger(length2, tiny), zero), one);
    const Vec d{to[k].x - s * edge[k].x, to[k].y - s * edge[k].y, to[k].z - s * edge[k].z};
    least = smaller(least, dot(d, d));
    scale = larger(scale, dot(to[k], to[k]));
    inside &= dot(cross(normal, edge[k]), to[k]) > zero;
  }
  const Doubles height = dot(normal, to[0]);
  const Doubles plane = height * height / larger(dot(normal, normal), tiny);
  least = inside ? smaller(least, plane) : least;
  store(least * all(1.0 - kOfSquare) - scale * all(kOfCorners) - all(from.slack2_mm2), distance2);
}

constexpr NearestKernels kKernels{boxes, triangles};
