// Sixteen pairs of triangles, a triangle a lane. Included by kernels_impl.h.
#include "common/geometry/kernels/lanes.h"

namespace discards {

using Lanes = Doubles;
using Mask = DoubleMask;

inline unsigned bits(Mask m) {
  return static_cast<unsigned>((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8));
}

struct Vector {
  Lanes x, y, z;
};
inline Vector corner(const FourTriangles& t, int k) {
  return {load(t.corner[k][0]), load(t.corner[k][1]), load(t.corner[k][2])};
}
// Corner k of triangle i in every lane.
inline Vector corner_of_one(const FourTriangles& t, int k, int i) {
  return {all(t.corner[k][0][i]), all(t.corner[k][1][i]), all(t.corner[k][2][i])};
}
inline Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector operator+(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Lanes dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The four bits of row i become column i.
inline unsigned transposed(unsigned mask) {
  unsigned out = 0;
  for (unsigned i = 0; i < 4; ++i)
    for (unsigned j = 0; j < 4; ++j) out |= ((mask >> (4 * i + j)) & 1U) << (4 * j + i);
  return out;
}

void place(const double* corners, int count, const Placement& at, FourTriangles& out) {
  for (int k = 0; k < 3; ++k) {
    Lanes u[3];
    for (int c = 0; c < 3; ++c) {
      const double* x = corners + 3 * k + c;
      u[c] = Lanes{x[0], x[count > 1 ? 9 : 0], x[count > 2 ? 18 : 0], x[count > 3 ? 27 : 0]} -
             all(at.origin[c]);
    }
    for (int c = 0; c < 3; ++c)
      store(
          (all(at.r[c][0]) * u[0] + all(at.r[c][1]) * u[1] + all(at.r[c][2]) * u[2]) + all(at.p[c]),
          out.corner[k][c]);
  }
}

void move(const double* corners, int count, const double* origin, FourTriangles& out) {
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 4; ++i)
        out.corner[k][c][i] = corners[9 * (i < count ? i : 0) + 3 * k + c] - origin[c];
}

// Rows are triangles of b, bits in a row those of a.
inline unsigned along(const FourTriangles& a, const FourTriangles& b, const Reach& reach) {
  const Vector n{all(reach.n[0]), all(reach.n[1]), all(reach.n[2])};
  const Lanes far_a =
      larger(larger(dot(n, corner(a, 0)), dot(n, corner(a, 1))), dot(n, corner(a, 2)));
  const Lanes near_b =
      smaller(smaller(dot(n, corner(b, 0)), dot(n, corner(b, 1))), dot(n, corner(b, 2)));
  unsigned mask = 0;
  for (int j = 0; j < 4; ++j) mask |= bits(all(near_b[j]) - far_a <= all(reach.mm)) << (4 * j);
  return mask;
}

inline unsigned boxes(const FourTriangles& a, const FourTriangles& b, Lanes reach2) {
  Lanes a_lo[3], a_hi[3], b_lo[3], b_hi[3];
  for (int c = 0; c < 3; ++c) {
    const Lanes a0 = load(a.corner[0][c]), a1 = load(a.corner[1][c]), a2 = load(a.corner[2][c]);
    const Lanes b0 = load(b.corner[0][c]), b1 = load(b.corner[1][c]), b2 = load(b.corner[2][c]);
    a_lo[c] = smaller(smaller(a0, a1), a2);
    a_hi[c] = larger(larger(a0, a1), a2);
    b_lo[c] = smaller(smaller(b0, b1), b2);
    b_hi[c] = larger(larger(b0, b1), b2);
  }
  unsigned mask = 0;
  for (int j = 0; j < 4; ++j) {
    Lanes square = all(0.0);
    for (int c = 0; c < 3; ++c) {
      const Lanes gap =
          larger(larger(all(b_lo[c][j]) - a_hi[c], a_lo[c] - all(b_hi[c][j])), all(0.0));
      square += gap * gap;
    }
    mask |= bits(square <= reach2) << (4 * j);
  }
  return mask;
}

// Along the normal of each triangle of `faces`. The extent of the face itself counts, too: the
// normal of a sliver is wrong. Rows are triangles of `others`.
inline unsigned over_faces(const FourTriangles& faces, const FourTriangles& others, Lanes reach2) {
  const Vector x0 = corner(faces, 0), x1 = corner(faces, 1), x2 = corner(faces, 2);
  const Vector n = cross(x1 - x0, x2 - x0);
  const Lanes nn = dot(n, n), limit = reach2 * nn;
  const Lanes f0 = dot(n, x0), f1 = dot(n, x1), f2 = dot(n, x2);
  const Lanes top = larger(larger(f0, f1), f2), bottom = smaller(smaller(f0, f1), f2);
  unsigned mask = 0;
  for (int j = 0; j < 4; ++j) {
    const Lanes h0 = dot(n, corner_of_one(others, 0, j));
    const Lanes h1 = dot(n, corner_of_one(others, 1, j));
    const Lanes h2 = dot(n, corner_of_one(others, 2, j));
    const Lanes gap =
        larger(smaller(smaller(h0, h1), h2) - top, bottom - larger(larger(h0, h1), h2));
    // Of a normal whose square is lost nothing is said.
    mask |= bits((gap <= all(0.0)) | (gap * gap <= limit) | (nn < all(1e-200))) << (4 * j);
  }
  return mask;
}

// Along the line between the centres, each pair its own.
inline unsigned between_centres(const FourTriangles& a, const FourTriangles& b, Lanes reach2,
                                unsigned wanted) {
  const Vector a0 = corner(a, 0), a1 = corner(a, 1), a2 = corner(a, 2);
  const Vector centre_a = a0 + a1 + a2;
  unsigned mask = 0;
  for (int j = 0; j < 4; ++j) {
    if (((wanted >> (4 * j)) & 15U) == 0) continue;
    const Vector b0 = corner_of_one(b, 0, j), b1 = corner_of_one(b, 1, j),
                 b2 = corner_of_one(b, 2, j);
    const Vector n = (b0 + b1 + b2) - centre_a;
    const Lanes far_a = larger(larger(dot(n, a0), dot(n, a1)), dot(n, a2));
    const Lanes near_b = smaller(smaller(dot(n, b0), dot(n, b1)), dot(n, b2));
    const Lanes gap = near_b - far_a;
    // Of a direction whose square is lost nothing is said.
    const Lanes nn = dot(n, n);
    mask |= bits((gap <= all(0.0)) | (gap * gap <= reach2 * nn) | (nn < all(1e-200))) << (4 * j);
  }
  return mask;
}

unsigned near_along(const FourTriangles& a, const FourTriangles& b, const Reach& reach) {
  return transposed(along(a, b, reach));
}

// Cheapest first.
unsigned near_pairs(const FourTriangles& a, const FourTriangles& b, const Reach& reach) {
  // Beyond it squares could overflow.
  if (!(reach.mm < 1e100)) return 0xffffU;
  const Lanes reach2 = all(reach.mm * reach.mm);
  unsigned mask = along(a, b, reach);
  if (mask == 0) return 0;
  mask &= boxes(a, b, reach2);
  if (mask == 0) return 0;
  mask &= over_faces(a, b, reach2);
  if (mask == 0) return 0;
  mask &= transposed(over_faces(b, a, reach2));
  if (mask == 0) return 0;
  mask &= between_centres(a, b, reach2, mask);
  return transposed(mask);
}

constexpr DiscardKernels kKernels{place, move, near_pairs, near_along};

}  // namespace discards
