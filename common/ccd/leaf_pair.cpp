#include "common/ccd/leaf_pair.h"

#include <algorithm>
#include <cmath>

namespace mortise::ccd {
namespace {

// Along the direction between their feet two triangles are as far apart as the feet. Less than this
// part of it: the direction is wrong by rounding.
constexpr double kTrustNormal = 0.9;

constexpr double kNever = std::numeric_limits<double>::infinity();

// Least dt with gap - s dt - bend dt^2 / 2 = 0; never where the parabola turns before. Of the two
// forms of the root the one in which nothing cancels.
double time_to_close(double gap, double s, double bend, double horizon) {
  if (!(gap > 0.0)) return 0.0;
  const double square = s * s + 2.0 * bend * gap;
  if (square < 0.0) return horizon;
  const double disc = std::sqrt(square);
  const double numerator = s >= 0.0 ? 2.0 * gap : disc - s;
  const double denominator = s >= 0.0 ? s + disc : bend;
  // Beyond 2^20 ticks is never.
  if (!(denominator > numerator * 0x1p-20)) return horizon;
  return std::min(numerator / denominator, horizon);
}

void load(const Bvh& bvh, std::uint32_t first, LeafCorners& corners) {
  for (int i = 0; i < Bvh::kLeafSize; ++i) {
    const auto& c = bvh.corners[first + (i < corners.count ? i : 0)];
    for (int k = 0; k < 3; ++k)
      for (int x = 0; x < 3; ++x) corners.at[k][x][i] = c[3 * k + x] - bvh.origin[x];
  }
}

Vec3 corner(const LeafCorners& corners, int i, int k) {
  return {corners.at[k][0][i], corners.at[k][1][i], corners.at[k][2][i]};
}

Vec3 vec(const double* x) { return {x[0], x[1], x[2]}; }

// Where a point is along n, and how it goes (see TurnTerms); `sign` -1 for what n points at.
struct Along {
  double place, s = 0.0, bend = 0.0;
};

Along along(const TurnTerms& terms, const Vec3& n, const Vec3& x, const Vec3& x_to_axis,
            double sign) {
  Along result{n.dot(x)};
  if (!terms.turns) return result;
  const Vec3 w = vec(terms.w);
  const Vec3 turn = w.cross(x + x_to_axis);
  const double s = sign * n.dot(turn), bend = sign * n.dot(w.cross(turn));
  result.s = s;
  result.bend = std::max(bend, bend * terms.bow) + terms.lift * std::max(-s, 0.0);
  return result;
}

}  // namespace

LeafPair::LeafPair(const Bvh& a, std::int32_t leaf_a, const Bvh& b, std::int32_t leaf_b)
    : bvh_a_(a), bvh_b_(b), first_a_(a.leaves[~leaf_a].first), first_b_(b.leaves[~leaf_b].first) {
  a_.count = static_cast<int>(a.leaves[~leaf_a].count);
  b_.count = static_cast<int>(b.leaves[~leaf_b].count);
  load(a, first_a_, a_);
  load(b, first_b_, b_);
}

void LeafPair::place(const PairMotion& motion) {
  const PairState& s = motion.state();
  if (placed_at_ == s.t) return;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < a_.count; ++i) x_[i][k] = s.R * corner(a_, i, k) + s.p;
    for (int j = 0; j < b_.count; ++j) y_[j][k] = corner(b_, j, k);
  }
  placed_at_ = s.t;
}

// For a given dt the gap left is linear in (place, speed, bend), and all three are linear in the
// point, bounds from above of them convex: the corners decide.
double LeafPair::free_time(const LeafFrame& frame, const Vec3& n, int i, int j,
                           double taken_mm) const {
  const double v = n.dot(vec(frame.v)) + frame.speed_slack;
  Along a[3], b[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = along(frame.a, n, x_[i][k], vec(frame.a.arm) - vec(frame.p), 1.0);
    b[k] = along(frame.b, n, y_[j][k], vec(frame.b.arm), -1.0);
  }
  double dt = frame.horizon;
  for (const Along& x : a)
    for (const Along& y : b)
      dt = std::min(dt, time_to_close(y.place - x.place - taken_mm, v + x.s + y.s,
                                      x.bend + y.bend + frame.bend_slack, frame.horizon));
  return dt;
}

Nearest LeafPair::exact(int i, int j, bool may_cross, CcdWork& work) const {
  ++work.triangle_tests;
  const TriangleDistance d =
      may_cross ? triangle_distance(x_[i], y_[j]) : triangle_distance_apart(x_[i], y_[j]);
  return {d.distance_mm,
          bvh_a_.triangle_order[first_a_ + i],
          bvh_b_.triangle_order[first_b_ + j],
          d.point_a,
          d.point_b,
          d.crossing};
}

// By the direction between the feet; by normals where that is noise.
bool LeafPair::settle(const PairMotion& motion, const LeafFrame& frame, const Goal& goal,
                      bool may_cross, int i, int j, LeafAdvance& result, CcdWork& work) const {
  Nearest found = exact(i, j, may_cross || goal.below_zero, work);
  double gap = found.distance_mm;
  Vec3 n = Vec3::Zero();
  const bool signed_gap = goal.below_zero && gap <= goal.exact_below_mm;
  if (signed_gap) {
    const TriangleSeparation separation = triangle_separation_outside(x_[i], y_[j]);
    n = separation.normal;
    found.distance_mm = gap = separation.distance_mm;
  } else if (gap > 0.0) {
    n = (found.point_b - found.point_a) / gap;
  }
  if (gap <= goal.contact_mm) {
    result = {0.0, true, found};
    return false;
  }
  const double taken = goal.target_mm + motion.rounding_mm();
  double dt = free_time(frame, n, i, j, taken);
  const auto gap_along = [&](const Vec3& direction) {
    double a = -kNever, b = kNever;
    for (int k = 0; k < 3; ++k) {
      a = std::max(a, direction.dot(x_[i][k]));
      b = std::min(b, direction.dot(y_[j][k]));
    }
    return b - a;
  };
  if (!signed_gap && gap_along(n) < kTrustNormal * gap)
    // The feet are so near that rounding has turned the direction between them. Normals of faces
    // and of pairs of edges do not know the distance.
    dt = std::max(dt, free_time(frame, triangle_separation(x_[i], y_[j]).normal, i, j, taken));
  if (dt < result.dt) {
    result.dt = dt;
    result.nearest = found;
  }
  return true;
}

// 1. the kernel frees what it can, and names the suspects;
// 2. those that touch at the start along the normals of their own faces: a sliding patch is freed
//    by them, the corners decide, no distance is needed;
// 3. what is left, by the exact distance.
LeafAdvance LeafPair::advance(PairMotion& motion, const Goal& goal, bool may_cross, double enough,
                              LeafKernel kernel, CcdWork& work) {
  ++work.leaf_tests;
  // At the start a pair within contact_mm must be seen, later it must not come within target_mm.
  // Where distances go below zero nothing is discarded that lies where they are asked for.
  const double near_mm = goal.below_zero ? goal.exact_below_mm : goal.contact_mm;
  const LeafFrame& frame =
      motion.leaf_frame(may_cross || goal.below_zero ? near_mm : goal.target_mm, near_mm);
  const LeafAnswer answer = kernel(frame, a_, b_, enough);
  LeafAdvance result;
  result.dt = answer.dt;
  if (answer.suspects == 0) return result;
  place(motion);
  const auto free_by_normals = [&](int i, int j) {
    if (!goal.below_zero) return false;
    const double last = std::min(result.dt, 1.0);
    for (const bool of_a : {false, true}) {
      const Triangle& t = of_a ? x_[i] : y_[j];
      const Vec3 outward = (t[1] - t[0]).cross(t[2] - t[0]);
      const double length = outward.norm();
      if (!(length > 0.0)) continue;
      const double dt = free_time(frame, outward * ((of_a ? 1.0 : -1.0) / length), i, j,
                                  goal.contact_mm + motion.rounding_mm());
      if (dt < last) continue;
      result.dt = std::min(result.dt, dt);
      return true;
    }
    return false;
  };
  for (int i = 0; i < a_.count; ++i)
    for (int j = 0; j < b_.count; ++j) {
      if ((answer.suspects >> (4 * i + j) & 1U) == 0 || free_by_normals(i, j)) continue;
      if (!settle(motion, frame, goal, may_cross, i, j, result, work)) return result;
    }
  return result;
}

bool LeafPair::boxes_apart(int i, int j, double limit_mm) const {
  double square = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double a_lo = std::min({x_[i][0][c], x_[i][1][c], x_[i][2][c]});
    const double a_hi = std::max({x_[i][0][c], x_[i][1][c], x_[i][2][c]});
    const double b_lo = std::min({y_[j][0][c], y_[j][1][c], y_[j][2][c]});
    const double b_hi = std::max({y_[j][0][c], y_[j][1][c], y_[j][2][c]});
    const double gap = std::max({0.0, b_lo - a_hi, a_lo - b_hi});
    square += gap * gap;
  }
  // Sixteen ulp: rounding of the sum and the root.
  return square * (1.0 - 16.0 * kUnitRoundoff) > limit_mm * limit_mm && limit_mm >= 0.0;
}

Nearest LeafPair::nearest(const PairMotion& motion, double limit_mm, CcdWork& work) {
  ++work.leaf_tests;
  place(motion);
  Nearest best;
  best.distance_mm = kNever;
  for (int i = 0; i < a_.count; ++i)
    for (int j = 0; j < b_.count; ++j) {
      if (boxes_apart(i, j, std::min(limit_mm, best.distance_mm))) continue;
      const Nearest found = exact(i, j, true, work);
      if (found.distance_mm < best.distance_mm && found.distance_mm <= limit_mm) best = found;
    }
  return best;
}

double LeafPair::closing_speed(const PairMotion& motion, const Vec3& n, const Triangle& a,
                               const Triangle& b) const {
  const PairState& s = motion.state();
  double fastest_a = -kNever, fastest_b = -kNever;
  for (int k = 0; k < 3; ++k) {
    fastest_a = std::max(fastest_a, n.dot(s.a.w.cross(a[k] - s.p + s.a.arm)));
    fastest_b = std::max(fastest_b, -n.dot(s.b.w.cross(b[k] + s.b.arm)));
  }
  return n.dot(s.a.v - s.b.v) + fastest_a + fastest_b;
}

}  // namespace mortise::ccd
