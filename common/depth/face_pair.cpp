#include "common/depth/face_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise {
namespace {

// Axes farther apart in angle are no sliding fit: the closed form would be far from tight.
constexpr double kLeastCosine = 0.95;

// Where along the common length the overlap at an end is taken.
constexpr double kEndShare = 0.002;

struct Line {
  Vec3 point, direction;
  Vec3 at(double z) const { return point + z * direction; }
  Vec3 across(const Vec3& x) const {
    const Vec3 d = x - point;
    return d - d.dot(direction) * direction;
  }
};

struct Shaft {
  Line axis;
  double radius_mm;
  FaceExtent extent;
};

// Point and outward normal of the hole's face, in the frame of both.
struct InHole {
  double lo_mm, hi_mm;
  Vec3 point, outward;
};

std::optional<InHole> shaft_in_hole(const Shaft& shaft, const Shaft& hole, double margin_mm) {
  const double cosine = std::fabs(shaft.axis.direction.dot(hole.axis.direction));
  if (cosine < kLeastCosine) return std::nullopt;
  const double tilt = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  // The part of the shaft's axis whose circle may be near the hole.
  const double beyond = margin_mm + shaft.radius_mm * tilt;
  const double slope = shaft.axis.direction.dot(hole.axis.direction);
  const double z0 = (shaft.axis.point - hole.axis.point).dot(hole.axis.direction);
  const auto along = [&](double hole_z) { return (hole_z - z0) / slope; };
  const auto clipped = [&](double grown) {
    const double a = along(hole.extent.lo_mm - grown), b = along(hole.extent.hi_mm + grown);
    return FaceExtent{std::max(shaft.extent.lo_mm, std::min(a, b)),
                      std::min(shaft.extent.hi_mm, std::max(a, b))};
  };
  const FaceExtent wide = clipped(beyond), narrow = clipped(0.0);
  if (wide.lo_mm > wide.hi_mm) return std::nullopt;
  InHole in;
  in.hi_mm = -std::numeric_limits<double>::infinity();
  for (const double z : {wide.lo_mm, wide.hi_mm})
    in.hi_mm = std::max(in.hi_mm, hole.axis.across(shaft.axis.at(z)).norm());
  in.hi_mm += shaft.radius_mm - hole.radius_mm;
  in.lo_mm = -std::numeric_limits<double>::infinity();
  if (narrow.lo_mm > narrow.hi_mm) return in;
  // The middle first: at the ends other faces are as near. A little inside of them, for the same
  // reason.
  const double length = narrow.hi_mm - narrow.lo_mm;
  for (const double share : {0.5, kEndShare, 1.0 - kEndShare}) {
    const double z = narrow.lo_mm + share * length;
    const Vec3 center = shaft.axis.at(z);
    const Vec3 away = hole.axis.across(center);
    Vec3 out = away - away.dot(shaft.axis.direction) * shaft.axis.direction;
    // Coaxial: every direction is the same.
    if (!(out.norm() > 1e-9 * shaft.radius_mm)) out = shaft.axis.direction.unitOrthogonal();
    const Vec3 point = center + shaft.radius_mm * out.normalized();
    const Vec3 from_axis = hole.axis.across(point);
    const double overlap = from_axis.norm() - hole.radius_mm;
    if (overlap <= in.lo_mm + 1e-9 * shaft.radius_mm) continue;
    in.lo_mm = overlap;
    in.point = point;
    in.outward = -from_axis.normalized();
  }
  return in;
}

}  // namespace

FaceExtent extent_of(const Body& body, std::uint16_t face, const Surface& surface) {
  (void)surface;
  const Interval& extent = body.extent_of(face);
  return {extent.lo, extent.hi};
}

std::optional<FacePairOverlap> face_pair_overlap(const Surface& a, const FaceExtent& extent_a,
                                                 const Surface& b, const FaceExtent& extent_b,
                                                 const Pose& X_BA, double margin_mm) {
  if (a.kind != b.kind || a.inward == b.inward) return std::nullopt;
  const Vec3 point_a = X_BA * a.point;
  if (a.kind == SurfaceKind::kCylinder) {
    const Shaft in_b_a{{point_a, X_BA.q * a.axis}, a.radius_mm, extent_a};
    const Shaft in_b_b{{b.point, b.axis}, b.radius_mm, extent_b};
    const auto in = a.inward ? shaft_in_hole(in_b_b, in_b_a, margin_mm)
                             : shaft_in_hole(in_b_a, in_b_b, margin_mm);
    if (!in) return std::nullopt;
    return FacePairOverlap{in->lo_mm, in->hi_mm, in->point,
                           a.inward ? Vec3(-in->outward) : in->outward};
  }
  if (a.kind == SurfaceKind::kSphere) {
    const Vec3& socket = a.inward ? point_a : b.point;
    const Vec3& ball = a.inward ? b.point : point_a;
    const double ball_radius = a.inward ? b.radius_mm : a.radius_mm;
    const double socket_radius = a.inward ? a.radius_mm : b.radius_mm;
    const double apart = (ball - socket).norm();
    const Vec3 out =
        apart > 1e-9 * ball_radius ? Vec3((ball - socket) / apart) : Vec3(Vec3::UnitZ());
    const double overlap = apart + ball_radius - socket_radius;
    return FacePairOverlap{overlap, overlap, ball + ball_radius * out, a.inward ? out : Vec3(-out)};
  }
  return std::nullopt;
}

bool is_round_in_bore(const Surface& a, const Surface& b) {
  if (a.inward == b.inward) return false;
  const Surface& bore = a.inward ? a : b;
  const Surface& round = a.inward ? b : a;
  return bore.kind == SurfaceKind::kCylinder &&
         (round.kind == SurfaceKind::kCylinder || round.kind == SurfaceKind::kCone);
}

InBoreBound in_bore_bound(const InBoreQuery& query, const Pose& X_BA) {
  InBoreBound bound;
  const Surface &a = *query.a, &b = *query.b;
  if (!is_round_in_bore(a, b)) return bound;
  const Line axis_a{X_BA * a.point, X_BA.q * a.axis}, axis_b{b.point, b.axis};
  const Line &bore = a.inward ? axis_a : axis_b, &round = a.inward ? axis_b : axis_a;
  const double bore_radius = a.inward ? a.radius_mm : b.radius_mm;
  const Surface& surface = a.inward ? b : a;
  const FaceExtent& extent = a.inward ? query.extent_b : query.extent_a;
  const FaceExtent& bore_extent = a.inward ? query.extent_a : query.extent_b;
  const double slope = round.direction.dot(bore.direction);
  if (std::fabs(slope) < kLeastCosine) return bound;
  const double tilt = std::sqrt(std::max(0.0, 1.0 - slope * slope));
  if (surface.kind == SurfaceKind::kCylinder) {
    // The circles around the axis that may be near the bore, wherever the face ends.
    const double beyond = query.margin_mm + surface.radius_mm * tilt;
    const double z0 = (round.point - bore.point).dot(bore.direction);
    double farthest = 0.0;
    for (const double z : {bore_extent.lo_mm - beyond, bore_extent.hi_mm + beyond})
      farthest = std::max(farthest, bore.across(round.at((z - z0) / slope)).norm());
    bound.face_mm = bound.within_mm = farthest + surface.radius_mm - bore_radius;
    return bound;
  }
  if (!(extent.lo_mm >= 0.0)) return bound;
  const double widening = std::tan(surface.half_angle_rad);
  bound.face_mm = -std::numeric_limits<double>::infinity();
  for (const double z : {extent.lo_mm, extent.hi_mm})
    bound.face_mm =
        std::max(bound.face_mm, bore.across(round.at(z)).norm() + z * widening - bore_radius);
  bound.face_mm += query.most_inward_mm * (1.0 - std::cos(surface.half_angle_rad) +
                                           tilt * std::sin(surface.half_angle_rad));
  return bound;
}

}  // namespace mortise
