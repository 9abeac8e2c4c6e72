#include "common/geometry/triangle_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.h"

namespace mortise {
namespace {

// Square of the ratio of height to longest edge below which a triangle is its edges: they differ by
// less than the rounding of its corners then.
constexpr double kFlat2 = 3e-30;

// Edges part two triangles (step 1 of distance_of) where the feet are this part of the longest edge
// apart, or where the corners lie behind them by more than rounding; in units of round-off times
// coordinate times edge.
constexpr double kFarFeet2 = 1.0 / 64.0;
constexpr double kBehindFeet = 16.0;

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
  int longest = 0;
  explicit Sides(const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      edge[k] = t[next(k)] - t[k];
      length2[k] = edge[k].squaredNorm();
      if (length2[k] > length2[longest]) longest = k;
    }
  }
};

// A triangle by its longest edge and the height upon it. Of a needle the height is known to
// round-off of the edge only: it is wrong by an angle that grows with the aspect, and so is the
// normal. Places along the edge and in parts of the height stay right.
class Face {
 public:
  Face(const Triangle& t, const Sides& sides) {
    const int k = sides.longest;
    base_ = t[k];
    along_ = sides.edge[k];
    along2_ = sides.length2[k];
    if (!(along2_ > 0.0)) return;
    const Vec3 to_apex = -sides.edge[next(next(k))];
    apex_ = to_apex.dot(along_) / along2_;
    across_ = to_apex - apex_ * along_;
    across_ -= (across_.dot(along_) / along2_) * along_;  // of a needle the first pass leaves some
    across2_ = across_.squaredNorm();
    normal_ = along_.cross(across_);
    flat_ = !(across2_ > kFlat2 * along2_) || normal_.isZero(0.0);
  }

  bool flat() const { return flat_; }
  /// Not unit; zero when flat.
  Vec3 normal() const { return flat_ ? Vec3::Zero() : normal_; }

  /// Foot of x on the plane when it lies over the triangle; always a point of the triangle.
  bool foot(const Vec3& x, Vec3& foot) const {
    const Vec3 r = x - base_;
    const double s = r.dot(along_) / along2_;
    const double h = (r - s * along_).dot(across_) / across2_;
    if (!(h >= 0.0 && s >= h * apex_ && s <= 1.0 - h * (1.0 - apex_))) return false;
    foot = normal_.dot(r) == 0.0 ? x : Vec3(base_ + s * along_ + h * across_);
    return true;
  }

  bool crossed_by(const Vec3& from, const Vec3& to) const {
    const double h0 = normal_.dot(from - base_), h1 = normal_.dot(to - base_);
    if ((h0 > 0.0) == (h1 > 0.0) || h0 == h1) return false;
    Vec3 unused;
    return foot(from + (to - from) * (h0 / (h0 - h1)), unused);
  }

 private:
  Vec3 base_, along_, across_ = Vec3::Zero(), normal_ = Vec3::Zero();
  double along2_ = 0.0, across2_ = 0.0, apex_ = 0.0;
  bool flat_ = true;
};

bool cross(const Triangle& a, const Face& face_a, const Triangle& b, const Face& face_b) {
  const auto any = [](const Triangle& edges, const Face& face) {
    if (face.flat()) return false;
    for (int k = 0; k < 3; ++k)
      if (face.crossed_by(edges[k], edges[next(k)])) return true;
    return false;
  };
  return any(a, face_b) || any(b, face_a);
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
  // Where the feet are close, rounding turns the direction between them: then the corners must lie
  // behind by more than that could hide.
  const auto parted = [&](double behind_a, double behind_b) {
    if (behind_a > 0.0 || behind_b < 0.0) return false;
    const double longest2 = std::max(sa.length2[sa.longest], sb.length2[sb.longest]);
    if (best2 >= kFarFeet2 * longest2) return true;
    double farthest2 = 0.0;
    for (int k = 0; k < 3; ++k)
      farthest2 = std::max({farthest2, a[k].squaredNorm(), b[k].squaredNorm()});
    const double hidden = kBehindFeet * kUnitRoundoff * std::sqrt(longest2 * farthest2);
    return behind_a <= -hidden && behind_b >= hidden;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Feet feet =
          nearest_of_edges(a[i], sa.edge[i], sa.length2[i], b[j], sb.edge[j], sb.length2[j]);
      if (!take(feet.p, feet.q)) continue;
      const Vec3 v = feet.q - feet.p;
      if (best2 > 0.0 && parted(v.dot(a[next(next(i))] - feet.p), v.dot(b[next(next(j))] - feet.q)))
        return done();
    }
  const Face face_a(a, sa), face_b(b, sb);
  Vec3 foot;
  if (!face_a.flat())
    for (int k = 0; k < 3; ++k)
      if (face_a.foot(b[k], foot)) take(foot, b[k]);
  if (!face_b.flat())
    for (int k = 0; k < 3; ++k)
      if (face_b.foot(a[k], foot)) take(a[k], foot);
  if (may_cross && best2 > 0.0 && cross(a, face_a, b, face_b)) {
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
  return cross(a, Face(a, sa), b, Face(b, sb));
}

namespace {

// Cosine of how near the back of both triangles a direction must point to be "behind" them (25
// degrees). Faces at a larger angle to one another cross when one goes through the other. Behind
// one of them alone proves nothing: there may be the other side of a sharp edge.
constexpr double kBehind = 0.9;

// More than a gap along a direction is rounded by, as a share of what is measured.
constexpr double kSeparationRounding = 1e-12;

TriangleSeparation separation_of(const Triangle& a, const Triangle& b, bool outside_only) {
  const Sides sa(a), sb(b);
  const Vec3 na = Face(a, sa).normal(), nb = Face(b, sb).normal();
  const Vec3 out_a = na.isZero(0.0) ? na : Vec3(na.normalized());
  const Vec3 out_b = nb.isZero(0.0) ? nb : Vec3(nb.normalized());
  const auto allowed = [&](const Vec3& from_a_to_b) {
    return !outside_only || from_a_to_b.dot(out_a) > -kBehind || from_a_to_b.dot(out_b) < kBehind;
  };
  TriangleSeparation best{-std::numeric_limits<double>::infinity(), Vec3::Zero()};
  // Relative to one corner: large common coordinates would cost digits.
  const Vec3 from[5] = {a[1] - a[0], a[2] - a[0], b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  double size_mm = 0.0;
  for (const Vec3& x : from) size_mm = std::max(size_mm, x.lpNorm<1>());
  const auto gaps = [&](const Vec3& n) {
    const double x1 = n.dot(from[0]), x2 = n.dot(from[1]), y0 = n.dot(from[2]), y1 = n.dot(from[3]),
                 y2 = n.dot(from[4]);
    return std::pair(std::min({y0, y1, y2}) - std::max({0.0, x1, x2}),
                     std::min({0.0, x1, x2}) - std::max({y0, y1, y2}));
  };
  // Most directions part them less than one before did: seen without their length.
  const auto along = [&](const Vec3& direction) {
    const double length2 = direction.squaredNorm();
    if (!(length2 > 0.0)) return;
    const double least_mm = best.distance_mm - kSeparationRounding * size_mm;
    const auto [ahead, behind] = gaps(direction);
    const double gap = std::max(ahead, behind);
    if (std::copysign(gap * gap, gap) < std::copysign(least_mm * least_mm * length2, least_mm))
      return;
    const Vec3 n = direction / std::sqrt(length2);
    const auto [ahead_mm, behind_mm] = gaps(n);
    if (ahead_mm > best.distance_mm && allowed(n)) best = {ahead_mm, n};
    if (behind_mm > best.distance_mm && allowed(-n)) best = {behind_mm, -n};
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
