#include "common/depth/search/tube_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace mortise {
namespace {

// How closely a closed form is followed around its circles; halvings before it is left wide.
constexpr double kTubeAccuracy_mm = 1e-5;
constexpr int kMostCircleHalvings = 20'000;

// To begin with; they are halved where their bound is too loose.
constexpr int kFirstArcs = 8;

// The law by which a ray leaves a ball holds where the ball is this many radii from the axis.
constexpr double kFarFromAxis = 2.0;

double turned_into(double rad) { return std::remainder(rad, 2.0 * std::numbers::pi); }

// How far an angle is outside of an arc, rad.
double beyond(const FaceArc& arc, double rad) {
  return arc.whole() ? 0.0 : std::fabs(turned_into(rad - arc.middle_rad)) - arc.half_rad;
}

struct Arc {
  double from = 0.0, to = 0.0;
  double upper_mm = 0.0;
  double middle() const { return 0.5 * (from + to); }
  double half() const { return 0.5 * (to - from); }
};

bool less(const Arc& a, const Arc& b) {
  return a.upper_mm != b.upper_mm ? a.upper_mm < b.upper_mm : a.from > b.from;
}

// A point of the tube's centre circle seen from the wall's axis.
struct SeenFromWall {
  double out = 0.0, up = 0.0;
};

class TubeSearch {
 public:
  TubeSearch(const Tube& tube, const TubeWall& wall, double margin_mm)
      : tube_(tube),
        wall_(*wall.surface),
        extent_(wall.extent),
        margin_mm_(margin_mm),
        e1_(tube.from),
        e2_(tube.axis.cross(tube.from)),
        f1_(wall.from),
        f2_(wall_.axis.cross(wall.from)) {
    // |across(c)|^2 = mean + first harmonic + second harmonic of the angle.
    const double r = tube.circle_mm;
    const Vec3 v0 = across(tube.center), v1 = r * flat(e1_), v2 = r * flat(e2_);
    first_ = 2.0 * std::hypot(v0.dot(v1), v0.dot(v2));
    second_ = 0.5 * std::hypot(v1.squaredNorm() - v2.squaredNorm(), 2.0 * v1.dot(v2));
    rise_ = r * std::hypot(e1_.dot(wall_.axis), e2_.dot(wall_.axis));
  }

  TubeReach run(double accuracy_mm) {
    std::vector<Arc> arcs = first_arcs();
    double settled = -kInfinity;
    for (int i = 0; i < kMostCircleHalvings && !arcs.empty(); ++i) {
      std::pop_heap(arcs.begin(), arcs.end(), less);
      const Arc arc = arcs.back();
      arcs.pop_back();
      if (arc.upper_mm <= most_ + accuracy_mm) {
        settled = std::max(settled, arc.upper_mm);
        break;  // none of the others is higher
      }
      for (const auto& [from, to] : {std::pair{arc.from, arc.middle()}, {arc.middle(), arc.to}})
        push(from, to, arc.upper_mm, arcs);
    }
    TubeReach reach{{best_, std::max(best_, settled)}, point_};
    if (!arcs.empty()) reach.reach_mm.hi = std::max(reach.reach_mm.hi, arcs.front().upper_mm);
    return reach;
  }

 private:
  std::vector<Arc> first_arcs() {
    std::vector<Arc> arcs;
    FaceArc all = tube_.around_axis;
    const double closest = tube_.circle_mm - tube_.radius_mm;
    const double more = closest > 0.0 ? (margin_mm_ + beyond_mm(0.0)) / closest : kInfinity;
    all.half_rad = std::min(std::numbers::pi, all.half_rad + more);
    const int count = tube_.circle_mm > 0.0 ? kFirstArcs : 1;
    for (int i = 0; i < count; ++i) {
      const double step = 2.0 * all.half_rad / count, from = all.middle_rad - all.half_rad;
      push(from + i * step, from + (i + 1) * step, kInfinity, arcs);
    }
    return arcs;
  }

  void push(double from, double to, double at_most, std::vector<Arc>& arcs) {
    Arc arc{from, to, 0.0};
    arc.upper_mm = std::min(at_most, upper(arc));
    if (!(arc.upper_mm > -kInfinity)) return;
    arcs.push_back(arc);
    std::push_heap(arcs.begin(), arcs.end(), less);
  }

  double upper(const Arc& arc) {
    const Vec3 middle = at(arc.middle());
    const SeenFromWall here = seen(middle);
    const double half = arc.half(), walked = tube_.circle_mm * half;
    if (is_off_wall(arc, middle, here, walked)) return -kInfinity;
    const double off = std::min(walked, box_half(arc, here, walked));
    const double depth = depth_mm(here, 0.0);
    most_ = std::max(most_, depth);
    look(arc.middle(), middle, here);
    return depth_mm(here, off);
  }

  // How far from its middle an arc goes, as seen from the wall's axis.
  double box_half(const Arc& arc, const SeenFromWall& here, double walked) const {
    const double least = here.out - walked;
    if (!(least > 0.0)) return kInfinity;
    const double bend_out = (first_ + 4.0 * second_) / (2.0 * least) +
                            std::pow(first_ + 2.0 * second_, 2.0) / (4.0 * std::pow(least, 3.0));
    double out = 0.0, up = 0.0;
    for (const double end : {arc.from, arc.to}) {
      const SeenFromWall there = seen(at(end));
      out = std::max(out, std::fabs(there.out - here.out));
      up = std::max(up, std::fabs(there.up - here.up));
    }
    const double bent = 0.5 * arc.half() * arc.half();
    return std::hypot(out + bent * bend_out, up + bent * rise_);
  }

  // Upper bound of the depth below the wall of any point of the balls about points that are no
  // farther than `off` from one, all as seen from the axis.
  double depth_mm(const SeenFromWall& c, double off) const {
    const double r = tube_.radius_mm;
    if (wall_.kind == SurfaceKind::kCylinder) {
      const double k = std::max(0.0, beyond_extent(c.up) - off);
      if (!(k < r)) return -kInfinity;
      const double out = c.out - wall_.radius_mm;
      return (wall_.inward ? out : -out) + off + std::sqrt(r * r - k * k);
    }
    if (wall_.kind != SurfaceKind::kTorus || !wall_.inward)
      return r + off - wall_.signed_distance_mm(wall_.point + c.out * f1_ + c.up * wall_.axis);
    const SeenFromWall w{c.out - wall_.radius_mm, c.up};
    const double length = std::hypot(w.out, w.up);
    const FaceArc face = reached_arc();
    const double straight = length + r + off - wall_.tube_radius_mm;
    const double across_mm = length + off;
    // From 0.9 r on the circle's own slope is worse than the straight bound.
    if (face.whole() || beyond(face, std::atan2(w.up, w.out)) <= 0.0 || !(across_mm < 0.9 * r) ||
        c.out - off < kFarFromAxis * r)
      return straight;
    double most = -kInfinity;
    for (const double side : {-1.0, 1.0}) {
      const double end = face.middle_rad + side * face.half_rad;
      const double p = w.out * std::cos(end) + w.up * std::sin(end);
      most = std::max(most, p + std::sqrt(std::max(0.0, r * r - length * length + p * p)));
    }
    const double steep = r / std::sqrt(r * r - across_mm * across_mm);
    return std::min(straight, most + off * steep - wall_.tube_radius_mm);
  }

  // By which the face of a torus goes on where its neighbours move, and the margin.
  double beyond_mm(double margin_mm) const {
    return margin_mm + std::max(extent_.beyond_mm[0], extent_.beyond_mm[1]);
  }
  FaceArc reached_arc() const {
    FaceArc arc = extent_.around_tube;
    arc.half_rad += beyond_mm(margin_mm_) / wall_.tube_radius_mm;
    return arc;
  }
  // How far a height is from those of the face.
  double beyond_extent(double z) const {
    return std::max({0.0, extent_.lo_mm - extent_.beyond_mm[0] - margin_mm_ - z,
                     z - extent_.hi_mm - extent_.beyond_mm[1] - margin_mm_});
  }

  // No point of the balls about an arc is on the part of a torus that the wall's face has.
  bool is_off_wall(const Arc& arc, const Vec3& middle, const SeenFromWall& here,
                   double walked) const {
    if (wall_.kind != SurfaceKind::kTorus || extent_.around_axis.whole()) return false;
    // Across the axis its points are that far from the middle, and the face that far from its ends.
    const double far =
        walked + tube_.radius_mm * out_of_plane(arc, middle, here, walked) + beyond_mm(margin_mm_);
    const double nearest = here.out - walked - tube_.radius_mm;
    if (!(nearest > far)) return false;
    return beyond(extent_.around_axis, turn_about_wall(middle)) > 1.1 * far / nearest;
  }

  // Sine of the angle between the planes through the axes, of the tube's and of the wall's, at
  // most.
  double out_of_plane(const Arc& arc, const Vec3& middle, const SeenFromWall& here,
                      double walked) const {
    const double least = here.out - walked;
    if (!(least > 0.0) || tube_.circle_mm == 0.0) return 1.0;
    const Vec3 along = wall_.axis.cross(across(middle)) / here.out;
    const double cosine = along.dot(along_circle(arc.middle()));
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return std::min(1.0, sine + arc.half() * (1.0 + tube_.circle_mm / least));
  }

  // The point of the tube's surface that is deepest there, if both faces have it.
  void look(double rad, const Vec3& c, const SeenFromWall& here) {
    Vec3 down = -wall_.outward_normal(c);
    if (wall_.kind == SurfaceKind::kTorus && wall_.inward) down = down_a_groove(c, here);
    if (wall_.kind == SurfaceKind::kCylinder) {
      const double k = beyond_extent(here.up) / tube_.radius_mm;
      const double side = here.up > extent_.hi_mm ? -1.0 : 1.0;
      down = std::sqrt(std::max(0.0, 1.0 - k * k)) * down + side * k * wall_.axis;
    }
    if (tube_.circle_mm > 0.0) {
      const Vec3 t = along_circle(rad);
      down -= down.dot(t) * t;
    }
    const double length = down.norm();
    if (!(length > 0.0)) return;
    const Vec3 n = down / length, x = c + tube_.radius_mm * n;
    const double depth = -wall_.signed_distance_mm(x);
    if (!(depth > best_) || !faces_have(rad, n, x)) return;
    best_ = depth;
    point_ = x;
  }

  // Down to where the ray in the direction that leads farthest leaves the ball.
  Vec3 down_a_groove(const Vec3& c, const SeenFromWall& here) const {
    const SeenFromWall w{here.out - wall_.radius_mm, here.up};
    const double r = tube_.radius_mm, length = std::hypot(w.out, w.up);
    double rad = length > 0.0 ? std::atan2(w.up, w.out) : extent_.around_tube.middle_rad;
    const FaceArc& face = extent_.around_tube;
    if (beyond(face, rad) > 0.0)
      rad = face.middle_rad + std::copysign(face.half_rad, turned_into(rad - face.middle_rad));
    const double p = w.out * std::cos(rad) + w.up * std::sin(rad);
    const double s = p + std::sqrt(std::max(0.0, r * r - length * length + p * p));
    const Vec3 radial = here.out > 0.0 ? Vec3(across(c) / here.out) : f1_;
    return (s * std::cos(rad) - w.out) * radial + (s * std::sin(rad) - w.up) * wall_.axis;
  }

  bool faces_have(double rad, const Vec3& n, const Vec3& x) const {
    // Far above the rounding of an arc tangent, far below what a part shows.
    constexpr double kSame_rad = 1e-9;
    const Vec3 radial = std::cos(rad) * e1_ + std::sin(rad) * e2_;
    if (tube_.circle_mm > 0.0 &&
        (beyond(tube_.around_axis, rad) > kSame_rad ||
         beyond(tube_.around_tube, std::atan2(n.dot(tube_.axis), n.dot(radial))) > kSame_rad))
      return false;
    const SeenFromWall at = seen(x);
    if (wall_.kind != SurfaceKind::kTorus)
      return !std::isfinite(extent_.hi_mm) ||
             (at.up >= extent_.lo_mm - kSame_rad * tube_.radius_mm &&
              at.up <= extent_.hi_mm + kSame_rad * tube_.radius_mm);
    return beyond(extent_.around_axis, turn_about_wall(x)) <= kSame_rad &&
           beyond(extent_.around_tube, std::atan2(at.up, at.out - wall_.radius_mm)) <= kSame_rad;
  }

  Vec3 flat(const Vec3& d) const { return d - d.dot(wall_.axis) * wall_.axis; }
  Vec3 across(const Vec3& x) const { return flat(x - wall_.point); }
  SeenFromWall seen(const Vec3& x) const {
    return {across(x).norm(), (x - wall_.point).dot(wall_.axis)};
  }
  double turn_about_wall(const Vec3& x) const {
    const Vec3 d = x - wall_.point;
    return std::atan2(d.dot(f2_), d.dot(f1_));
  }
  Vec3 at(double rad) const {
    return tube_.center + tube_.circle_mm * (std::cos(rad) * e1_ + std::sin(rad) * e2_);
  }
  Vec3 along_circle(double rad) const { return std::cos(rad) * e2_ - std::sin(rad) * e1_; }

  const Tube& tube_;
  const Surface& wall_;
  const FaceExtent& extent_;
  const double margin_mm_;
  const Vec3 e1_, e2_, f1_, f2_;
  double first_ = 0.0, second_ = 0.0, rise_ = 0.0;
  double best_ = -kInfinity, most_ = -kInfinity;
  Vec3 point_ = Vec3::Zero();
};

// Both surfaces as far as they go.
TubeReach continued(Tube tube, TubeWall wall) {
  tube.around_axis = tube.around_tube = {};
  wall.extent = {-kInfinity, kInfinity};
  return tube_reach(tube, wall, 0.0, kTubeAccuracy_mm);
}

}  // namespace

std::optional<Tube> Tube::of(const Surface& surface, const FaceExtent& extent) {
  if (surface.inward) return std::nullopt;
  Tube tube{surface.point, surface.axis, surface.axis.unitOrthogonal()};
  if (surface.kind == SurfaceKind::kSphere) {
    tube.radius_mm = surface.radius_mm;
    return tube;
  }
  if (surface.kind != SurfaceKind::kTorus) return std::nullopt;
  tube.circle_mm = surface.radius_mm;
  tube.radius_mm = surface.tube_radius_mm;
  tube.around_axis = extent.around_axis;
  tube.around_tube = extent.around_tube;
  return tube;
}

TubeReach tube_reach(const Tube& tube, const TubeWall& wall, double margin_mm, double accuracy_mm) {
  return TubeSearch(tube, wall, margin_mm).run(accuracy_mm);
}

std::optional<FacePairOverlap> tube_overlap(const Surface& a, const FaceExtent& extent_a,
                                            const Surface& b, const FaceExtent& extent_b,
                                            const Pose& X_BA, double margin_mm,
                                            const std::array<PairOffsets, 2>* layers) {
  Surface a_B = a;
  a_B.point = X_BA * a.point;
  a_B.axis = X_BA.q * a.axis;
  const Vec3 from_a = X_BA.q * a.axis.unitOrthogonal(), from_b = b.axis.unitOrthogonal();
  // Of two tubes the torus, whose circle is followed.
  const bool a_is_tube = Tube::of(a, extent_a).has_value() &&
                         (a.kind == SurfaceKind::kTorus || !Tube::of(b, extent_b).has_value());
  std::optional<Tube> tube = a_is_tube ? Tube::of(a_B, extent_a) : Tube::of(b, extent_b);
  if (!tube) return std::nullopt;
  tube->from = a_is_tube ? from_a : from_b;
  const TubeWall wall{a_is_tube ? &b : &a_B, a_is_tube ? extent_b : extent_a,
                      a_is_tube ? from_b : from_a};
  const TubeReach near = tube_reach(*tube, wall, margin_mm, kTubeAccuracy_mm);
  if (!std::isfinite(near.reach_mm.hi)) return std::nullopt;
  const TubeReach reach = tube_reach(*tube, wall, 0.0, kTubeAccuracy_mm);
  FacePairOverlap found{reach.reach_mm.lo, reach.reach_mm.hi,
                        std::max(near.reach_mm.hi, reach.reach_mm.hi)};
  found.continued_hi_mm = continued(*tube, wall).reach_mm.hi;
  found.point_B = reach.point;
  found.normal_B = b.outward_normal(found.point_B);
  found.of_layer_mm.fill({found.lo_mm, found.hi_mm});
  // At the end of a groove the radius of the layer counts.
  for (std::size_t i = 0; layers != nullptr && i < layers->size(); ++i) {
    const double offset = a_is_tube ? (*layers)[i].a_mm : (*layers)[i].b_mm;
    if (offset == 0.0) continue;
    Tube of_layer = *tube;
    of_layer.radius_mm += offset;
    const TubeReach at = tube_reach(of_layer, wall, 0.0, kTubeAccuracy_mm);
    const TubeReach more = tube_reach(of_layer, wall, margin_mm, kTubeAccuracy_mm);
    found.of_layer_mm[i] = at.reach_mm + Interval{-offset, -offset};
    found.lo_mm = std::min(found.lo_mm, found.of_layer_mm[i].lo);
    found.hi_mm = std::max(found.hi_mm, found.of_layer_mm[i].hi);
    found.near_hi_mm = std::max({found.near_hi_mm, found.hi_mm, more.reach_mm.hi - offset});
  }
  return found;
}

}  // namespace mortise
