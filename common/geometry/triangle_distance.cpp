#include "common/geometry/triangle_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise {
namespace {

// Square of the sine of a corner below which a triangle is its edges: its plane is then wrong by
// round-off / sine of its length, its edges by sine / 2; equal at sqrt(2 * 1.1e-16).
constexpr double kFlatSine2 = 2.2e-16;

// Square of the sine between two edges below which they are parallel: the foot points on them would
// be noise. Their distance varies by less than an ulp of their length there.
constexpr double kParallelSine2 = 1e-30;

constexpr int next(int k) { return k == 2 ? 0 : k + 1; }

double clamp01(double x) { return x < 0.0 ? 0.0 : (x > 1.0 ? 1.0 : x); }

struct Feet {
  Vec3 p, q;
};

// Nearest points of the segments p + [0,1] a and q + [0,1] b.
Feet nearest_of_edges(const Vec3& p, const Vec3& a, double aa, const Vec3& q, const Vec3& b,
                      double bb) {
  const Vec3 r = q - p;
  const double ab = a.dot(b), ar = a.dot(r), br = b.dot(r);
  double s = 0.0;
  // By the cross product, not by aa * bb - ab^2, which loses half the digits for small angles.
  const Vec3 n = a.cross(b);
  const double nn = n.squaredNorm();
  if (nn > kParallelSine2 * aa * bb) s = clamp01(r.cross(b).dot(n) / nn);
  const double t = bb > 0.0 ? clamp01((ab * s - br) / bb) : 0.0;
  s = aa > 0.0 ? clamp01((ab * t + ar) / aa) : 0.0;
  return {p + s * a, q + t * b};
}

struct Sides {
  Vec3 edge[3];
  double length2[3];
  explicit Sides(const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      edge[k] = t[next(k)] - t[k];
      length2[k] = edge[k].squaredNorm();
    }
  }
  // Normal, not unit; from the two shorter edges, whose cross product loses least. Zero when flat.
  Vec3 normal() const {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (length2[k] > length2[longest]) longest = k;
    const int i = next(longest), j = next(i);
    const Vec3 n = edge[i].cross(edge[j]);
    return n.squaredNorm() > kFlatSine2 * length2[i] * length2[j] ? n : Vec3::Zero();
  }
};

bool over_face(const Vec3& x, const Triangle& t, const Sides& sides, const Vec3& n) {
  for (int k = 0; k < 3; ++k)
    if (sides.edge[k].cross(x - t[k]).dot(n) < 0.0) return false;
  return true;
}

bool edge_crosses(const Vec3& from, const Vec3& to, const Triangle& t, const Sides& sides,
                  const Vec3& n) {
  const double h0 = n.dot(from - t[0]), h1 = n.dot(to - t[0]);
  if ((h0 > 0.0) == (h1 > 0.0) || h0 == h1) return false;
  return over_face(from + (to - from) * (h0 / (h0 - h1)), t, sides, n);
}

bool cross(const Triangle& a, const Sides& sa, const Vec3& na, const Triangle& b, const Sides& sb,
           const Vec3& nb) {
  const auto any = [](const Triangle& edges, const Triangle& face, const Sides& sides,
                      const Vec3& n) {
    if (n.isZero(0.0)) return false;
    for (int k = 0; k < 3; ++k)
      if (edge_crosses(edges[k], edges[next(k)], face, sides, n)) return true;
    return false;
  };
  return any(a, b, sb, nb) || any(b, a, sa, na);
}

// 1. edge against edge: if the third corners lie behind the feet, the slab between the feet parts
//    the triangles and nothing can be nearer.
// 2. corner against face, likewise.
// 3. neither: the triangles cross, or rounding hid the slab; then the least of all is the answer.
TriangleDistance distance_of(const Triangle& a, const Triangle& b, bool may_cross) {
  const Sides sa(a), sb(b);
  TriangleDistance best;
  double best2 = std::numeric_limits<double>::infinity();
  const auto take = [&](const Vec3& p, const Vec3& q) {
    const double d2 = (q - p).squaredNorm();
    if (d2 >= best2) return false;
    best2 = d2;
    best.point_a = p;
    best.point_b = q;
    return true;
  };
  const auto done = [&] {
    best.distance_mm = std::sqrt(best2);
    return best;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Feet feet =
          nearest_of_edges(a[i], sa.edge[i], sa.length2[i], b[j], sb.edge[j], sb.length2[j]);
      if (!take(feet.p, feet.q)) continue;
      const Vec3 v = feet.q - feet.p;
      if (best2 > 0.0 && v.dot(a[next(next(i))] - feet.p) <= 0.0 &&
          v.dot(b[next(next(j))] - feet.q) >= 0.0)
        return done();
    }
  const Vec3 na = sa.normal(), nb = sb.normal();
  const auto corners_over = [&](const Triangle& corners, const Triangle& face, const Sides& sides,
                                const Vec3& n, bool corners_of_b) {
    if (n.isZero(0.0)) return;
    const double nn = n.squaredNorm();
    for (int k = 0; k < 3; ++k) {
      if (!over_face(corners[k], face, sides, n)) continue;
      const Vec3 foot = corners[k] - n * (n.dot(corners[k] - face[0]) / nn);
      if (corners_of_b)
        take(foot, corners[k]);
      else
        take(corners[k], foot);
    }
  };
  corners_over(b, a, sa, na, true);
  corners_over(a, b, sb, nb, false);
  if (may_cross && best2 > 0.0 && cross(a, sa, na, b, sb, nb)) {
    best.crossing = true;
    best2 = 0.0;
  }
  return done();
}

}  // namespace

TriangleDistance triangle_distance(const Triangle& a, const Triangle& b) {
  return distance_of(a, b, true);
}

TriangleDistance triangle_distance_apart(const Triangle& a, const Triangle& b) {
  return distance_of(a, b, false);
}

bool triangles_cross(const Triangle& a, const Triangle& b) {
  const Sides sa(a), sb(b);
  return cross(a, sa, sa.normal(), b, sb, sb.normal());
}

namespace {

// Cosine of how near the back of both triangles a direction must point to be "behind" them (25
// degrees). Faces at a larger angle to one another cross when one goes through the other. Behind
// one of them alone proves nothing: there may be the other side of a sharp edge.
constexpr double kBehind = 0.9;

TriangleSeparation separation_of(const Triangle& a, const Triangle& b, bool outside_only) {
  const Sides sa(a), sb(b);
  const Vec3 na = sa.normal(), nb = sb.normal();
  const Vec3 out_a = na.isZero(0.0) ? na : Vec3(na.normalized());
  const Vec3 out_b = nb.isZero(0.0) ? nb : Vec3(nb.normalized());
  const auto allowed = [&](const Vec3& from_a_to_b) {
    return !outside_only || from_a_to_b.dot(out_a) > -kBehind || from_a_to_b.dot(out_b) < kBehind;
  };
  TriangleSeparation best{-std::numeric_limits<double>::infinity(), Vec3::Zero()};
  const auto along = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0.0)) return;
    const Vec3 n = direction / length;
    // Relative to one corner: large common coordinates would cost digits.
    double a_lo = 0.0, a_hi = 0.0, b_lo = n.dot(b[0] - a[0]), b_hi = b_lo;
    for (int k = 1; k < 3; ++k) {
      const double x = n.dot(a[k] - a[0]), y = n.dot(b[k] - a[0]);
      a_lo = std::min(a_lo, x);
      a_hi = std::max(a_hi, x);
      b_lo = std::min(b_lo, y);
      b_hi = std::max(b_hi, y);
    }
    if (b_lo - a_hi > best.distance_mm && allowed(n)) best = {b_lo - a_hi, n};
    if (a_lo - b_hi > best.distance_mm && allowed(-n)) best = {a_lo - b_hi, -n};
  };
  along(na);
  along(nb);
  for (int i = 0; i < 3; ++i) {
    along(sa.edge[i].cross(na));
    along(sb.edge[i].cross(nb));
    for (int j = 0; j < 3; ++j) along(sa.edge[i].cross(sb.edge[j]));
  }
  if (best.normal.isZero(0.0))  // both without area, and parallel
    for (int c = 0; c < 3; ++c) along(Vec3::Unit(c));
  return best;
}

}  // namespace

TriangleSeparation triangle_separation(const Triangle& a, const Triangle& b) {
  return separation_of(a, b, false);
}

TriangleSeparation triangle_separation_outside(const Triangle& a, const Triangle& b) {
  return separation_of(a, b, true);
}

}  // namespace mortise
