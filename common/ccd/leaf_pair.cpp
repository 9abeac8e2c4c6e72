#include "common/ccd/leaf_pair.h"

#include <algorithm>
#include <cmath>

namespace mortise::ccd {
namespace {

// Along the direction between their feet two triangles are as far apart as the feet. Less than this
// part of it: the direction is wrong by rounding.
constexpr double kTrustNormal = 0.9;

constexpr double kNever = std::numeric_limits<double>::infinity();

Triangle corners_of(const Bvh& bvh, std::uint32_t i) {
  const auto& c = bvh.corners[i];
  return {Vec3(c[0], c[1], c[2]), Vec3(c[3], c[4], c[5]), Vec3(c[6], c[7], c[8])};
}

// Least dt with gap - s dt - bend dt^2 / 2 = 0; of the two forms of the root the one in which
// nothing cancels.
double time_to_close(double gap, double s, double bend) {
  if (gap <= 0.0) return 0.0;
  const double disc = std::sqrt(s * s + 2.0 * bend * gap);
  if (s >= 0.0) return s + disc > 0.0 ? 2.0 * gap / (s + disc) : kNever;
  return bend > 0.0 ? (disc - s) / bend : kNever;
}

}  // namespace

LeafPair::LeafPair(const Bvh& a, std::int32_t leaf_a, const Bvh& b, std::int32_t leaf_b)
    : bvh_a_(a),
      bvh_b_(b),
      first_a_(a.leaves[~leaf_a].first),
      first_b_(b.leaves[~leaf_b].first),
      count_a_(static_cast<int>(a.leaves[~leaf_a].count)),
      count_b_(static_cast<int>(b.leaves[~leaf_b].count)) {
  for (int j = 0; j < count_b_; ++j) {
    const Triangle corners = corners_of(b, first_b_ + j);
    for (int k = 0; k < 3; ++k) y_[j][k] = corners[k] - b.origin;
  }
}

void LeafPair::place(const PairMotion& motion) {
  const PairState& s = motion.state();
  for (int i = 0; i < count_a_; ++i) {
    const Triangle corners = corners_of(bvh_a_, first_a_ + i);
    for (int k = 0; k < 3; ++k) {
      u_[i][k] = s.R * (corners[k] - bvh_a_.origin);
      x_[i][k] = u_[i][k] + s.p;
      rho_a_[i][k] = motion.turns_a() ? s.a.axis.cross(u_[i][k] + s.a.arm).norm() : 0.0;
    }
  }
  for (int j = 0; j < count_b_; ++j)
    for (int k = 0; k < 3; ++k)
      rho_b_[j][k] = motion.turns_b() ? s.b.axis.cross(y_[j][k] + s.b.arm).norm() : 0.0;
}

LeafPair::Direction::Direction(const PairMotion& motion, const Vec3& n_B) : n(n_B) {
  const PairState& s = motion.state();
  turn_a = n.cross(s.a.w);
  turn_b = n.cross(s.b.w);
  speed_a = n.dot(s.a.v);
  speed_b = n.dot(s.b.v);
  bend_a = turn_a.norm() * motion.speed_a();
  bend_b = turn_b.norm() * motion.speed_b();
}

LeafPair::Along LeafPair::along_a(const Direction& d, int i) const {
  Along along;
  for (int k = 0; k < 3; ++k) {
    along.place[k] = d.n.dot(x_[i][k]);
    along.speed[k] = d.speed_a + d.turn_a.dot(u_[i][k]);
    along.bend[k] = d.bend_a * rho_a_[i][k];
  }
  return along;
}

LeafPair::Along LeafPair::along_b(const Direction& d, int j) const {
  Along along;
  for (int k = 0; k < 3; ++k) {
    along.place[k] = d.n.dot(y_[j][k]);
    along.speed[k] = -(d.speed_b + d.turn_b.dot(y_[j][k]));
    along.bend[k] = d.bend_b * rho_b_[j][k];
  }
  return along;
}

// For a given dt the gap left is linear in (place, speed, bend), and bend is convex over a triangle
// from above: the corners decide.
double LeafPair::free_time(const PairMotion& motion, const Along& a, const Along& b,
                           double target_mm) const {
  const double taken = target_mm + motion.rounding_mm();
  const double slack = motion.speed_rounding_mm();
  if (!motion.turns_b()) {
    const double wall = std::min({b.place[0], b.place[1], b.place[2]}) - taken;
    if (!motion.turns_a())
      return time_to_close(wall - std::max({a.place[0], a.place[1], a.place[2]}),
                           a.speed[0] + b.speed[0] + slack, 0.0);
    double dt = kNever;
    for (int k = 0; k < 3; ++k)
      dt = std::min(dt,
                    time_to_close(wall - a.place[k], a.speed[k] + b.speed[0] + slack, a.bend[k]));
    return dt;
  }
  double dt = kNever;
  for (int k = 0; k < 3; ++k)
    for (int m = 0; m < 3; ++m)
      dt = std::min(dt, time_to_close(b.place[m] - a.place[k] - taken,
                                      a.speed[k] + b.speed[m] + slack, a.bend[k] + b.bend[m]));
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

// 1. the pair that decided last time (at first: the pair whose centres are nearest);
// 2. every other pair first along the normal of that one: on a convex place it is freed by it;
// 3. along the normals of its own faces: a sliding patch is freed by them;
// 4. what is left, by the exact distance.
LeafAdvance LeafPair::advance(const PairMotion& motion, const Goal& goal, bool may_cross,
                              CcdWork& work) {
  ++work.leaf_tests;
  place(motion);
  if (try_i_ < 0) {
    double nearest2 = kNever;
    for (int i = 0; i < count_a_; ++i)
      for (int j = 0; j < count_b_; ++j) {
        const double d2 =
            (x_[i][0] + x_[i][1] + x_[i][2] - y_[j][0] - y_[j][1] - y_[j][2]).squaredNorm();
        if (d2 < nearest2) {
          nearest2 = d2;
          try_i_ = i;
          try_j_ = j;
        }
      }
  }
  LeafAdvance result;
  result.dt = kNever;
  // True when the pair is in contact.
  const auto settle = [&](int i, int j, Vec3& n) {
    Nearest found = exact(i, j, may_cross || goal.below_zero, work);
    double gap = found.distance_mm;
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
      return true;
    }
    double dt = 0.0;
    const auto free_along = [&](const Vec3& direction) {
      const Direction d(motion, direction);
      const Along a = along_a(d, i), b = along_b(d, j);
      dt = std::max(dt, free_time(motion, a, b, goal.target_mm));
      return std::min({b.place[0], b.place[1], b.place[2]}) -
             std::max({a.place[0], a.place[1], a.place[2]});
    };
    if (free_along(n) < kTrustNormal * gap && !signed_gap) {
      // The feet are so near that rounding has turned the direction between them. Normals of faces
      // and of pairs of edges do not know the distance.
      const Vec3 by_features = triangle_separation(x_[i], y_[j]).normal;
      const double before = dt;
      free_along(by_features);
      if (dt > before) n = by_features;
    }
    if (dt < result.dt) {
      result.dt = dt;
      result.nearest = found;
      try_i_ = i;
      try_j_ = j;
    }
    return false;
  };
  // Free for the whole tick, or for longer than what is known already, along the normal of either
  // face: all of a patch that touches and slides. The corners decide; no distance is needed. Pairs
  // that do not start in touch are seldom freed so.
  const auto free_by_normals = [&](int i, int j) {
    if (!goal.below_zero) return false;
    const double enough = std::min(result.dt, 1.0);
    for (const bool of_a : {false, true}) {
      const Triangle& t = of_a ? x_[i] : y_[j];
      const Vec3 outward = (t[1] - t[0]).cross(t[2] - t[0]);
      const double length = outward.norm();
      if (!(length > 0.0)) continue;
      const Direction d(motion, outward * ((of_a ? 1.0 : -1.0) / length));
      const double dt = free_time(motion, along_a(d, i), along_b(d, j), goal.contact_mm);
      if (dt < enough) continue;
      result.dt = std::min(result.dt, dt);
      return true;
    }
    return false;
  };
  const int first_i = try_i_, first_j = try_j_;
  Vec3 n = Vec3::Zero();
  const bool first_free = free_by_normals(first_i, first_j);
  if (!first_free && settle(first_i, first_j, n)) return result;
  if (count_a_ == 1 && count_b_ == 1) return result;
  // At the start a pair within contact_mm must be seen, later it must not come within target_mm.
  const double kept_mm = may_cross ? goal.contact_mm : goal.target_mm;
  const Direction d(motion, n);
  Along b[kMost];
  for (int j = 0; j < count_b_; ++j) b[j] = along_b(d, j);
  for (int i = 0; i < count_a_; ++i) {
    const Along a = along_a(d, i);
    for (int j = 0; j < count_b_; ++j) {
      if (i == first_i && j == first_j) continue;
      if (!first_free && free_time(motion, a, b[j], kept_mm) >= result.dt) continue;
      if (free_by_normals(i, j)) continue;
      Vec3 own;
      if (settle(i, j, own)) return result;
    }
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
  for (int i = 0; i < count_a_; ++i)
    for (int j = 0; j < count_b_; ++j) {
      if (boxes_apart(i, j, std::min(limit_mm, best.distance_mm))) continue;
      const Nearest found = exact(i, j, true, work);
      if (found.distance_mm < best.distance_mm && found.distance_mm <= limit_mm) best = found;
    }
  return best;
}

double LeafPair::closing_speed(const PairMotion& motion, const Vec3& n, const Triangle& a,
                               const Triangle& b) const {
  const Direction d(motion, n);
  const Vec3& p = motion.state().p;
  double fastest_a = -kNever, fastest_b = -kNever;
  for (int k = 0; k < 3; ++k) {
    fastest_a = std::max(fastest_a, d.speed_a + d.turn_a.dot(a[k] - p));
    fastest_b = std::max(fastest_b, -(d.speed_b + d.turn_b.dot(b[k])));
  }
  return fastest_a + fastest_b;
}

}  // namespace mortise::ccd
