#include "common/depth/search/round_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace mortise {
namespace {

// At the very end of a face its neighbour is as near: a point is named that is a little inside.
constexpr double kEndShare = 1e-4;

// Axes that leave each other by less than this over the whole face are parallel.
constexpr double kParallel_mm = 1e-9;

// First pieces of the circle, and pieces looked at before the bracket is left as it is.
constexpr int kFirstPieces = 16;
constexpr int kMostPieces = 600;

// A direction around the convex axis, and what is asked of it again and again.
struct Turn {
  explicit Turn(double angle_rad)
      : angle(angle_rad), cosine(std::cos(angle_rad)), sine(std::sin(angle_rad)) {}
  // Half-way between two that are less than half a turn apart.
  Turn(const Turn& from, const Turn& to)
      : angle(0.5 * (from.angle + to.angle)),
        cosine(from.cosine + to.cosine),
        sine(from.sine + to.sine) {
    const double length = std::sqrt(cosine * cosine + sine * sine);
    cosine /= length;
    sine /= length;
  }
  double angle, cosine, sine;
};

// Where the circle is cut first.
const std::array<Turn, kFirstPieces + 1>& first_turns() {
  static const auto kTurns = []<std::size_t... i>(std::index_sequence<i...>) {
    return std::array{Turn(2.0 * std::numbers::pi * i / kFirstPieces)...};
  }
  (std::make_index_sequence<kFirstPieces + 1>());
  return kTurns;
}

struct ArcPiece {
  Turn from, middle, to;
  double bound;
};

class RoundSearch {
 public:
  RoundSearch(const RoundFace& convex, const RoundFace& hollow)
      : convex_(convex),
        hollow_(hollow),
        slope_(convex.axis.dot(hollow.axis)),
        cosine_(1.0 / std::hypot(1.0, hollow.widening)),
        e1_(convex.axis.unitOrthogonal()),
        e2_(convex.axis.cross(e1_)),
        rise_(e1_.dot(hollow.axis), e2_.dot(hollow.axis)),
        flat1_(e1_ - rise_.x() * hollow.axis),
        flat2_(e2_ - rise_.y() * hollow.axis),
        square1_(flat1_.squaredNorm()),
        square2_(flat2_.squaredNorm()),
        second_(std::hypot(0.5 * (square1_ - square2_), flat1_.dot(flat2_))) {}

  std::optional<RoundReach> run(double margin_mm, double accuracy_mm) {
    margin_mm_ = margin_mm;
    if (const auto reach = parallel_cylinders()) return reach;
    std::vector<ArcPiece> pieces;
    pieces.reserve(4 * kFirstPieces);
    const auto add = [&](const Turn& from, const Turn& to) {
      const Turn middle(from, to);
      const double bound = upper(from, middle, to);
      if (bound > -kInfinity) pieces.push_back({from, middle, to, bound});
      look(middle);
    };
    for (std::size_t i = 0; i < kFirstPieces; ++i) add(first_turns()[i], first_turns()[i + 1]);
    const auto lower = [](const ArcPiece& a, const ArcPiece& b) { return a.bound < b.bound; };
    std::make_heap(pieces.begin(), pieces.end(), lower);
    for (int looked = kFirstPieces; !pieces.empty() && looked < kMostPieces; looked += 2) {
      if (pieces.front().bound <= most_ + accuracy_mm) break;
      std::pop_heap(pieces.begin(), pieces.end(), lower);
      const ArcPiece piece = pieces.back();
      pieces.pop_back();
      for (const auto& [from, to] :
           {std::pair(piece.from, piece.middle), std::pair(piece.middle, piece.to)}) {
        const std::size_t before = pieces.size();
        add(from, to);
        if (pieces.size() > before) std::push_heap(pieces.begin(), pieces.end(), lower);
      }
    }
    RoundReach reach;
    if (pieces.empty()) {  // they pass each other
      reach.reach_mm = {-kInfinity, -kInfinity};
      return reach;
    }
    return reached(std::max(best_, pieces.front().bound));
  }

 private:
  std::optional<RoundReach> reached(double hi_mm) const {
    if (!std::isfinite(hi_mm)) return std::nullopt;
    RoundReach reach;
    reach.reach_mm = {best_, hi_mm};
    reach.point = point_;
    const Vec3 from_axis = across(point_);
    reach.outward = -cosine_ * (from_axis.stableNormalized() - hollow_.widening * hollow_.axis);
    return reach;
  }

  // Cylinders whose axes are parallel reach the distance of the axes beyond the wall, wherever they
  // are side by side. Nothing for others.
  std::optional<RoundReach> parallel_cylinders() {
    if (convex_.widening != 0.0 || hollow_.widening != 0.0) return std::nullopt;
    const double farthest =
        std::max(std::fabs(convex_.extent_mm.lo), std::fabs(convex_.extent_mm.hi));
    const double tilt_mm = rise_.norm() * (farthest + convex_.radius_mm);
    if (tilt_mm > kParallel_mm) return std::nullopt;
    const double rise = rise_.norm();
    const Interval along = within({-rise, rise}, near());
    RoundReach apart;
    apart.reach_mm = {-kInfinity, -kInfinity};
    if (!(along.lo <= along.hi)) return apart;
    const Vec3 off = across(convex_.point);
    const double side = off.norm() > kParallel_mm ? std::atan2(off.dot(e2_), off.dot(e1_))
                                                  : std::numbers::pi / kFirstPieces;
    look(Turn(side));
    const double reach_mm = off.norm() + convex_.radius_mm - hollow_.radius_mm + tilt_mm;
    return reached(std::max(best_, reach_mm));
  }

  Vec3 across(const Vec3& x) const {
    const Vec3 d = x - hollow_.point;
    return d - d.dot(hollow_.axis) * hollow_.axis;
  }
  double height(const Vec3& x) const { return (x - hollow_.point).dot(hollow_.axis); }
  Vec3 at(double t, const Turn& turn, double times = 1.0) const {
    return convex_.point + t * convex_.axis +
           times * convex_.radius_at(t) * (turn.cosine * e1_ + turn.sine * e2_);
  }
  double rise_at(const Turn& turn) const { return rise_.x() * turn.cosine + rise_.y() * turn.sine; }
  double beyond(const Vec3& x) const {
    return cosine_ * (across(x).norm() - hollow_.radius_at(height(x)));
  }

  // Where the generator whose direction rises by `rise` along the hollow axis meets a height; one
  // that is some times as far from the axis, by as many times the rise.
  double cut(double rise, double z) const {
    const double z0 = height(convex_.point);
    const double along = slope_ + convex_.widening * rise;
    return (z - z0 - convex_.radius_mm * rise) / along;
  }

  // Range of t on generators whose rises lie in an interval, where heights lie in another.
  Interval within(const Interval& rise, const Interval& z) const {
    Interval t{kInfinity, -kInfinity};
    for (const double r : {rise.lo, rise.hi})
      for (const double h : {z.lo, z.hi}) {
        t.lo = std::min(t.lo, cut(r, h));
        t.hi = std::max(t.hi, cut(r, h));
      }
    return {std::max(t.lo, convex_.extent_mm.lo), std::min(t.hi, convex_.extent_mm.hi)};
  }

  // Heights along the hollow axis of what is near.
  Interval near() const {
    return {hollow_.extent_mm.lo - margin_mm_, hollow_.extent_mm.hi + margin_mm_};
  }

  // A point of the convex face at both ends of its generator, and in the middle; and how far it
  // reaches at the very ends of what is near, to which the bounds come down.
  void look(const Turn& turn) {
    const double rise = rise_at(turn);
    const Interval ends = within({rise, rise}, near());
    if (ends.lo <= ends.hi)
      most_ = std::max({most_, beyond(at(ends.lo, turn)), beyond(at(ends.hi, turn))});
    const Interval t = within({rise, rise}, hollow_.extent_mm);
    if (!(t.lo <= t.hi)) return;
    for (const double share : {0.5, kEndShare, 1.0 - kEndShare}) {
      const Vec3 x = at(t.lo + share * (t.hi - t.lo), turn);
      const double reach = beyond(x);
      if (reach <= best_ + 1e-9 * convex_.radius_at(t.hi)) continue;
      best_ = reach;
      point_ = x;
    }
  }

  // No point of the convex face between two angles is farther beyond the wall: f is convex, so that
  // it is largest at an end of a generator. Two bounds for what the ends run along, the less of
  // which holds: that of the corners around it is close on a tilted face, that of the curvature
  // where the axes nearly meet.
  double upper(const Turn& from, const Turn& middle, const Turn& to) const {
    const double width = to.angle - from.angle;
    const double r0 = rise_at(from), r1 = rise_at(to);
    const double bulge = rise_.norm() * width * width / 8.0;
    const Interval rise{std::min(r0, r1) - bulge, std::max(r0, r1) + bulge};
    const Interval z = near();
    const Interval t = within(rise, z);
    if (!(t.lo <= t.hi)) return -kInfinity;
    const bool along = slope_ > 0.0;
    const double corners =
        std::max(around(Edge::kLower, along ? z.lo : z.hi, rise, {from, middle, to}),
                 around(Edge::kUpper, along ? z.hi : z.lo, rise, {from, middle, to}));
    if (corners <= most_) return corners;
    return std::min(corners, std::max(on_circle(t.lo, from, to), on_circle(t.hi, from, to)));
  }

  enum class Edge { kLower, kUpper };
  struct Arc {
    const Turn &from, &middle, &to;
  };

  // Upper bound of f over one end of the generators of an arc: that of the face, or the height z
  // where the hollow face ends, whichever comes first.
  double around(Edge edge, double z, const Interval& rise, const Arc& arc) const {
    const double end = edge == Edge::kUpper ? convex_.extent_mm.hi : convex_.extent_mm.lo;
    const double cut0 = cut(rise.lo, z), cut1 = cut(rise.hi, z);
    const bool may_cut =
        edge == Edge::kUpper ? std::min(cut0, cut1) < end : std::max(cut0, cut1) > end;
    const bool may_end =
        edge == Edge::kUpper ? std::max(cut0, cut1) > end : std::min(cut0, cut1) < end;
    double most = -kInfinity;
    if (may_cut || !may_end)
      most = corners_of(arc, [&](double rise_of) { return cut(rise_of, z); });
    if (may_end) most = std::max(most, corners_of(arc, [&](double) { return end; }));
    return most;
  }

  // A plane section of the face between two generators lies within the triangle of its ends and
  // the place where its tangents there meet: on the line in which the tangent planes of both meet,
  // that many times as far from the axis as the face. along(rise): t on a generator.
  template <class Along>
  double corners_of(const Arc& arc, const Along& along) const {
    const double half = 0.5 * (arc.to.angle - arc.from.angle);
    const double times = 1.0 / std::cos(half);
    const auto f = [&](const Turn& turn, double of) {
      return beyond(at(along(of * rise_at(turn)), turn, of));
    };
    return std::max({f(arc.from, 1.0), f(arc.middle, times), f(arc.to, 1.0)});
  }

  // Upper bound of f over an arc of the circle at t: at most above its ends by the curvature.
  double on_circle(double t, const Turn& from, const Turn& to) const {
    const double ends = std::max(beyond(at(t, from)), beyond(at(t, to)));
    return ends + bulge(t, convex_.point + t * convex_.axis, 0.5 * (to.angle - from.angle));
  }

  double bulge(double t, const Vec3& center, double half) const {
    const double radius = convex_.radius_at(t);
    const Vec3 v0 = across(center);
    // |v0 + r flat1 cos + r flat2 sin|^2 = mean + first harmonic + second harmonic.
    const double mean = v0.squaredNorm() + 0.5 * radius * radius * (square1_ + square2_);
    const double along1 = v0.dot(flat1_), along2 = v0.dot(flat2_);
    const double first = 2.0 * radius * std::sqrt(along1 * along1 + along2 * along2);
    const double second = radius * radius * second_;
    const double least = mean - first - second;
    if (!(least > 0.0)) return kInfinity;
    const double bend =
        (first + 4.0 * second) / (2.0 * std::sqrt(least)) +
        (first + 2.0 * second) * (first + 2.0 * second) / (4.0 * least * std::sqrt(least)) +
        std::fabs(hollow_.widening) * radius * rise_.norm();
    return cosine_ * bend * half * half / 2.0;
  }

  const RoundFace& convex_;
  const RoundFace& hollow_;
  const double slope_, cosine_;
  const Vec3 e1_, e2_;
  const Eigen::Vector2d rise_;  // of a turn about the convex axis, along the hollow one
  const Vec3 flat1_, flat2_;    // e1 and e2 square to the hollow axis
  const double square1_, square2_, second_;
  double margin_mm_ = 0.0;
  double best_ = -kInfinity, most_ = -kInfinity;
  Vec3 point_ = Vec3::Zero();
};

}  // namespace

std::optional<RoundFace> RoundFace::of(const Surface& surface, const Interval& extent_mm) {
  if (surface.kind == SurfaceKind::kCylinder)
    return RoundFace{surface.point, surface.axis, surface.radius_mm, 0.0, extent_mm};
  // Beyond its apex a cone would have a negative radius.
  if (surface.kind == SurfaceKind::kCone && extent_mm.lo >= 0.0)
    return RoundFace{surface.point, surface.axis, 0.0, std::tan(surface.half_angle_rad), extent_mm};
  return std::nullopt;
}

std::optional<RoundReach> round_reach(const RoundFace& convex, const RoundFace& hollow,
                                      double margin_mm, double accuracy_mm) {
  const double slope = convex.axis.dot(hollow.axis);
  if (std::fabs(slope) < kSlidingFitCosine) return std::nullopt;
  // A generator that runs square to the hollow axis meets no height of it.
  const double tilt = std::sqrt(std::max(0.0, 1.0 - slope * slope));
  // Half of square is far enough from it: the search's heights stay finite.
  if (std::fabs(convex.widening) * tilt > 0.5 * std::fabs(slope)) return std::nullopt;
  return RoundSearch(convex, hollow).run(margin_mm, accuracy_mm);
}

}  // namespace mortise
