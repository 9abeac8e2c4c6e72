#include "common/ccd/screw_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mortise::ccd {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;                       // rad
constexpr double kInfinity = std::numeric_limits<double>::infinity();  // of no bound yet
// rad: no angle of a hull is larger (a tree has at most 43 levels, each of which may add a turn).
constexpr double kLargestAngle = 64.0 * kTurn;
// Directions are chosen from as many triangles of a mesh: faces that are fewer than one in a
// thousand decide nothing.
constexpr std::size_t kSample = 2048;
// Classes of directions over half a turn, 3 degrees each: a patch of 1 mm seen by 1.5 degrees
// askew grows by 0.03 mm, less than the play of a thread.
constexpr int kClasses = 60;
// rad: below some ten degrees the pairs that are near at the start are most of a query.
constexpr double kWorthTurning = 0.25;
// Of both meshes: 32 MB of bounds in the scratch memory of a thread. Threads have some ten
// thousand.
constexpr std::size_t kMostTriangles = 200'000;
// Share of the children that are kept apart: with fewer the questions cost more than they spare. It
// is judged after so many.
constexpr double kWorthAsking = 0.0625;
constexpr std::uint64_t kAskedAtLeast = 4096;
// Rounding of a time to float.
constexpr float kShorter = 1.0F - 0x1p-22F;

Vec3 corner_of(const Bvh& bvh, std::size_t i, int k) {
  const auto& c = bvh.corners[i];
  return Vec3(c[3 * k], c[3 * k + 1], c[3 * k + 2]) - bvh.origin;
}

}  // namespace

ScrewBounds::ScrewBounds(PairMotion& motion, const Bvh& a, const Bvh& b, double taken_mm,
                         CcdScratch& scratch)
    : a_turns_(motion.turns_a()) {
  const PairState& s = motion.at(0.0);
  const BodyState& turning = a_turns_ ? s.a : s.b;
  const Vec3 v = a_turns_ ? Vec3(s.a.v - s.b.v) : Vec3(s.b.v - s.a.v);
  speed_ = turning.w.norm();
  const Vec3 axis = turning.w / speed_;
  const Vec3 across = axis.unitOrthogonal();
  Mat3 N;
  N << across.transpose(), axis.cross(across).transpose(), axis.transpose();
  const Vec3 on_axis = (a_turns_ ? s.p : Vec3(Vec3::Zero())) - turning.arm;
  a_ = {&a, &scratch.hulls[0], &scratch.triangle_hulls[0], N * s.R, N * (s.p - on_axis)};
  b_ = {&b, &scratch.hulls[1], &scratch.triangle_hulls[1], N, N * -on_axis};
  lead_mm_ = v.dot(axis) / speed_;
  const double drift_mm = (v - v.dot(axis) * axis).norm();
  round_mm_ = 4.0 * motion.rounding_mm() +
              kRoundingFactor * kUnitRoundoff * kLargestAngle * std::fabs(lead_mm_);
  near_mm_ = std::max(taken_mm, 0.0) + drift_mm + 4.0 * motion.rounding_mm();
  for (const Body* body : {&a_, &b_}) {
    body->hulls->assign(body->bvh->nodes.size() + body->bvh->leaves.size(), Hull{});
    body->triangles->resize(body->bvh->corners.size());
  }
  choose_directions();
}

bool ScrewBounds::applies(const PairMotion& motion, const Bvh& a, const Bvh& b, double t) {
  return a.corners.size() + b.corners.size() <= kMostTriangles &&
         motion.turns_a() != motion.turns_b() && motion.turning() * (1.0 - t) > kWorthTurning;
}

// The normals of the faces, as they lie in the plane (r, zeta): those of the most surface.
void ScrewBounds::choose_directions() {
  struct Class {
    double area2 = 0.0, r = 0.0, zeta = 0.0;
  };
  std::array<Class, kClasses> classes;
  for (const Body* body : {&a_, &b_}) {
    const std::size_t count = body->bvh->corners.size(), step = 1 + count / kSample;
    for (std::size_t i = 0; i < count; i += step) {
      Vec3 x[3];
      for (int k = 0; k < 3; ++k) x[k] = body->R * corner_of(*body->bvh, i, k) + body->p;
      const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]), middle = x[0] + x[1] + x[2];
      const double r = std::hypot(middle[0], middle[1]);
      if (!(r > 0.0)) continue;
      double n_r = (n[0] * middle[0] + n[1] * middle[1]) / r, n_zeta = n[2];
      if (n_zeta < 0.0) n_r = -n_r, n_zeta = -n_zeta;
      const double part = std::atan2(n_zeta, n_r) / std::numbers::pi;
      Class& one = classes[std::clamp(static_cast<int>(part * kClasses), 0, kClasses - 1)];
      one.area2 += std::hypot(n_r, n_zeta);
      one.r += n_r;
      one.zeta += n_zeta;
    }
  }
  for (int k = 0; k < kDirections; ++k) {
    // The first of equals.
    Class& most =
        *std::max_element(classes.begin(), classes.end(),
                          [](const Class& x, const Class& y) { return x.area2 < y.area2; });
    const double length = std::hypot(most.r, most.zeta);
    const double spread = k * std::numbers::pi / kDirections;
    r_[k] = length > 0.0 ? most.r / length : std::cos(spread);
    zeta_[k] = length > 0.0 ? most.zeta / length : std::sin(spread);
    most = {};
  }
}

// README, section 9: r is convex, and not below its tangent at the middle; theta is that of the
// plane through the corners but for half its largest second derivative times the square of the
// radius of the triangle.
CcdScratch::ScrewHull ScrewBounds::of_triangle(const Vec3* x) const {
  const double middle_x = (x[0][0] + x[1][0] + x[2][0]) / 3.0;
  const double middle_y = (x[0][1] + x[1][1] + x[2][1]) / 3.0;
  const double middle = std::sqrt(middle_x * middle_x + middle_y * middle_y);
  const double u_x = middle_x / middle, u_y = middle_y / middle;
  double r[3], tangent[3], theta[3], radius2 = 0.0;
  for (int k = 0; k < 3; ++k) {
    tangent[k] = u_x * x[k][0] + u_y * x[k][1];
    r[k] = std::sqrt(x[k][0] * x[k][0] + x[k][1] * x[k][1]);
    theta[k] = std::atan2(u_x * x[k][1] - u_y * x[k][0], tangent[k]);
    const double d_x = x[k][0] - middle_x, d_y = x[k][1] - middle_y;
    radius2 = std::max(radius2, d_x * d_x + d_y * d_y);
  }
  const double least_r = std::min({tangent[0], tangent[1], tangent[2]});
  Hull one;
  one.state = Hull::kRoundAxis;
  // NaN where the middle is on the axis.
  if (!(least_r > near_mm_)) return one;
  const double bent = 0.5 * radius2 / (least_r * least_r) * std::fabs(lead_mm_);
  const double at = std::atan2(u_y, u_x);
  one.state = Hull::kKnown;
  one.least_r_mm = least_r;
  one.theta_lo = at + std::min({theta[0], theta[1], theta[2]});
  one.theta_hi = at + std::max({theta[0], theta[1], theta[2]});
  double zeta[3];
  for (int k = 0; k < 3; ++k) zeta[k] = x[k][2] - lead_mm_ * (at + theta[k]);
  for (int d = 0; d < kDirections; ++d) {
    const double* most = r_[d] >= 0.0 ? r : tangent;
    const double* least = r_[d] >= 0.0 ? tangent : r;
    double lo = kInfinity, hi = -kInfinity;
    for (int k = 0; k < 3; ++k) {
      lo = std::min(lo, r_[d] * least[k] + zeta_[d] * zeta[k]);
      hi = std::max(hi, r_[d] * most[k] + zeta_[d] * zeta[k]);
    }
    one.lo[d] = lo - std::fabs(zeta_[d]) * bent;
    one.hi[d] = hi + std::fabs(zeta_[d]) * bent;
  }
  return one;
}

// Of the angles that mean the same direction those nearest to what is there already.
void ScrewBounds::merge(Hull& hull, Hull other) const {
  if (hull.state == Hull::kRoundAxis) return;
  if (hull.state == Hull::kUnknown || other.state == Hull::kRoundAxis) {
    hull = other;
    return;
  }
  const double turns =
      std::round((hull.theta_lo + hull.theta_hi - other.theta_lo - other.theta_hi) / (2.0 * kTurn));
  const double theta = turns * kTurn, zeta = -theta * lead_mm_;
  hull.theta_lo = std::min(hull.theta_lo, other.theta_lo + theta);
  hull.theta_hi = std::max(hull.theta_hi, other.theta_hi + theta);
  hull.least_r_mm = std::min(hull.least_r_mm, other.least_r_mm);
  for (int d = 0; d < kDirections; ++d) {
    hull.lo[d] = std::min(hull.lo[d], other.lo[d] + zeta_[d] * zeta);
    hull.hi[d] = std::max(hull.hi[d], other.hi[d] + zeta_[d] * zeta);
  }
}

CcdScratch::ScrewHull ScrewBounds::of_leaf(const Body& body, std::int32_t leaf) {
  const Bvh::Leaf& triangles = body.bvh->leaves[~leaf];
  Hull all;
  for (std::uint32_t i = triangles.first; i < triangles.first + triangles.count; ++i) {
    Vec3 x[3];
    for (int k = 0; k < 3; ++k) x[k] = body.R * corner_of(*body.bvh, i, k) + body.p;
    Hull& one = (*body.triangles)[i];
    one = of_triangle(x);
    merge(all, one);
  }
  return all;
}

CcdScratch::ScrewHull ScrewBounds::of_node(const Body& body, std::int32_t node) {
  Hull all;
  for (int k = 0; k < body.bvh->nodes[node].count; ++k)
    merge(all, hull(body, body.bvh->nodes[node].child[k]));
  return all;
}

const CcdScratch::ScrewHull& ScrewBounds::hull(const Body& body, std::int32_t node) {
  Hull& known = (*body.hulls)[node >= 0 ? static_cast<std::size_t>(node)
                                        : body.bvh->nodes.size() + static_cast<std::size_t>(~node)];
  if (known.state == Hull::kUnknown) known = node >= 0 ? of_node(body, node) : of_leaf(body, node);
  return known;
}

// The angles of `other` are `turns` turns more than they say.
bool ScrewBounds::apart(const Hull& turning, const Hull& other, double turns,
                        double slack_mm) const {
  const double zeta = -turns * kTurn * lead_mm_;
  double most = -kInfinity;
  for (int d = 0; d < kDirections; ++d) {
    const double shift = zeta_[d] * zeta;
    most = std::max(most, other.lo[d] + shift - turning.hi[d]);
    most = std::max(most, turning.lo[d] - other.hi[d] - shift);
  }
  return most > slack_mm;
}

bool ScrewBounds::keeps_children(const CcdScratch::Item& item, float* dt) {
  std::fill_n(dt, Bvh::kWidth, 0.0F);
  if (asked_ >= kAskedAtLeast &&
      static_cast<double>(kept_) < kWorthAsking * static_cast<double>(asked_))
    return false;
  const bool open_a = opens_a(item, *a_.bvh, *b_.bvh);
  const Bvh::Node& node = open_a ? a_.bvh->nodes[item.a] : b_.bvh->nodes[item.b];
  bool all = true;
  for (int k = 0; k < node.count; ++k) {
    const double until = open_a ? free_until(node.child[k], item.b, item.t)
                                : free_until(item.a, node.child[k], item.t);
    dt[k] = static_cast<float>(until - item.t) * kShorter;
    ++asked_;
    kept_ += until > item.t ? 1 : 0;
    all = all && until >= kNever;
  }
  return all;
}

double ScrewBounds::free_until(std::int32_t a, std::int32_t b, double t) {
  const double whole = free_until(hull(a_, a), hull(b_, b), t);
  if (whole >= kNever || a >= 0 || b >= 0) return whole;
  const Bvh::Leaf &leaf_a = a_.bvh->leaves[~a], &leaf_b = b_.bvh->leaves[~b];
  double free = kNever;
  for (std::uint32_t i = leaf_a.first; i < leaf_a.first + leaf_a.count; ++i)
    for (std::uint32_t j = leaf_b.first; j < leaf_b.first + leaf_b.count; ++j) {
      free = std::min(free, free_until((*a_.triangles)[i], (*b_.triangles)[j], t));
      if (free <= whole) return whole;
    }
  return free;
}

double ScrewBounds::free_until(const Hull& of_a, const Hull& of_b, double t) const {
  if (of_a.state == Hull::kRoundAxis || of_b.state == Hull::kRoundAxis) return t;
  const Hull& turning = a_turns_ ? of_a : of_b;
  const Hull& other = a_turns_ ? of_b : of_a;
  const double between_r = std::max(of_a.least_r_mm, of_b.least_r_mm) - near_mm_;
  const double theta_slack = near_mm_ / between_r + kRoundingFactor * kUnitRoundoff * kLargestAngle;
  const double slack_mm = near_mm_ * (1.0 + std::fabs(lead_mm_) / between_r) + round_mm_;
  // Angles of the turning body, less those of the other, when the two begin to meet and when they
  // have passed: at `first` + k turns and `last` + k turns.
  const double first = other.theta_lo - turning.theta_hi - theta_slack;
  const double last = other.theta_hi - turning.theta_lo + theta_slack;
  double free = kNever;
  for (double k = std::ceil((speed_ * t - last) / kTurn); k * kTurn + first <= speed_; ++k) {
    if (apart(turning, other, k, slack_mm)) continue;
    free = std::min(free, std::max(t, (k * kTurn + first) / speed_));
    break;
  }
  return free;
}

}  // namespace mortise::ccd
