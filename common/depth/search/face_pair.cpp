#include "common/depth/search/face_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "common/depth/search/round_pair.h"
#include "common/depth/search/tube_reach.h"

namespace mortise {
namespace {

// How closely a closed form is followed around its circles.
constexpr double kRoundAccuracy_mm = 1e-5;

struct Line {
  Vec3 point, direction;
  Vec3 at(double z) const { return point + z * direction; }
  Vec3 across(const Vec3& x) const {
    const Vec3 d = x - point;
    return d - d.dot(direction) * direction;
  }
};

Surface moved(Surface surface, const Pose& X) {
  surface.point = X * surface.point;
  surface.axis = X.q * surface.axis;
  return surface;
}

// The direction from the centre of a ball that leads farthest along d, among those that end between
// two heights; nothing when none does.
std::optional<Vec3> farthest_direction(const Vec3& d, const Vec3& axis, const Interval& rise) {
  if (rise.lo > 1.0 || rise.hi < -1.0) return std::nullopt;
  const double length = d.norm();
  const Vec3 straight = length > 0.0 ? Vec3(d / length) : Vec3::Zero();
  const double along = straight.dot(axis);
  if (length > 0.0 && along >= rise.lo && along <= rise.hi) return straight;
  const double z = std::clamp(length > 0.0 ? along : 0.5 * (rise.lo + rise.hi),
                              std::max(-1.0, rise.lo), std::min(1.0, rise.hi));
  Vec3 flat = straight - along * axis;
  // Straight along the axis: any way across is as near.
  if (!(flat.norm() > 1e-12)) flat = axis.unitOrthogonal();
  return Vec3(z * axis + std::sqrt(std::max(0.0, 1.0 - z * z)) * flat.normalized());
}

// A ball in a socket that is open on one side or both: its deepest point within the socket.
std::optional<FacePairOverlap> ball_in_socket(const Surface& ball, const Surface& socket,
                                              const FaceExtent& extent, double margin_mm) {
  const Vec3 d = ball.point - socket.point;
  const double z = d.dot(socket.axis);
  const auto reach = [&](double below, double above) -> std::optional<Vec3> {
    const auto u = farthest_direction(
        d, socket.axis,
        {(extent.lo_mm - below - z) / ball.radius_mm, (extent.hi_mm + above - z) / ball.radius_mm});
    if (!u) return std::nullopt;
    return Vec3(ball.point + ball.radius_mm * *u);
  };
  const auto overlap = [&](const Vec3& x) { return (x - socket.point).norm() - socket.radius_mm; };
  FacePairOverlap found;
  found.lo_mm = found.hi_mm = found.near_hi_mm = -std::numeric_limits<double>::infinity();
  const auto& [below, above] = extent.beyond_mm;
  if (const auto end = reach(below, above)) found.hi_mm = overlap(*end);
  if (const auto far = reach(margin_mm + below, margin_mm + above))
    found.near_hi_mm = overlap(*far);
  if (const auto near = reach(0.0, 0.0)) {
    found.lo_mm = overlap(*near);
    found.point_B = *near;
    found.normal_B = (*near - socket.point).stableNormalized();
  }
  return found;
}

// Layer by layer, each with the radii that it has.
FacePairOverlap ball_in_socket(const Surface& ball, const Surface& socket, const FaceExtent& extent,
                               double margin_mm, std::span<const PairOffsets, 2> layers) {
  FacePairOverlap found = *ball_in_socket(ball, socket, extent, margin_mm);
  const double end =
      std::min(0.99 * socket.radius_mm, std::max(std::fabs(extent.lo_mm), std::fabs(extent.hi_mm)));
  const double steep = 1.0 / (1.0 - std::pow(end / socket.radius_mm, 2.0));
  const double bend = steep * (ball.point - socket.point).norm() / std::pow(socket.radius_mm, 2.0);
  double lo = std::numeric_limits<double>::infinity(), hi = -lo, near_hi = -lo;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    Surface b = ball, s = socket;
    b.radius_mm += layers[i].a_mm;
    s.radius_mm -= layers[i].b_mm;
    const double offsets = layers[i].a_mm + layers[i].b_mm;
    const FacePairOverlap of_ball = *ball_in_socket(b, s, extent, margin_mm);
    // Of the points of both parts the deepest is on the rim or above it on the ball; between them
    // the depth is a line but for its bend.
    const auto of_both = [&](const FaceExtent& ends, double margin, double on_ball_mm) {
      const auto beyond = beyond_socket(b, s, ends, margin);
      const double most = std::max(
          on_ball_mm, beyond ? beyond->depth_mm : -std::numeric_limits<double>::infinity());
      return most + bend * std::pow(std::max(0.0, most), 2.0) - offsets;
    };
    const auto at = beyond_socket(b, s, {extent.lo_mm, extent.hi_mm}, 0.0);
    Interval& of_layer = found.of_layer_mm[i];
    of_layer.lo = (at && std::isfinite(of_ball.lo_mm) ? at->depth_mm : of_ball.lo_mm) - offsets;
    of_layer.hi = std::max(of_layer.lo, of_both(extent, 0.0, of_ball.hi_mm));
    lo = std::min(lo, of_layer.lo);
    hi = std::max(hi, of_layer.hi);
    near_hi = std::max(near_hi, of_both(extent, margin_mm, of_ball.near_hi_mm));
  }
  found.lo_mm = lo;
  found.hi_mm = hi;
  found.near_hi_mm = std::max(hi, near_hi);
  return found;
}

}  // namespace

FaceExtent extent_of(const Body& body, std::uint16_t face, const Surface& surface) {
  const FaceEnds& ends = body.ends_of(face);
  // A face goes on where the one that ends it moves outward.
  double moved_mm = 0.0;
  for (std::size_t i = 0; i < body.band->faces.size(); ++i)
    if (i != face)
      moved_mm = std::max(moved_mm, Body::offset_of(body.band->faces[i], Layer::kUpper));
  FaceExtent extent{ends.extent_mm.lo,
                    ends.extent_mm.hi,
                    {moved_mm, moved_mm},
                    ends.around_axis,
                    ends.around_tube};
  // The pole of a sphere need not be a corner.
  const Interval& off = body.band->faces[face].deviation_mm;
  if (surface.kind == SurfaceKind::kSphere || surface.kind == SurfaceKind::kTorus)
    for (int end = 0; end < 2; ++end)
      if (!ends.level[end])
        extent.beyond_mm[end] = std::max({moved_mm, std::fabs(off.lo), std::fabs(off.hi)});
  return extent;
}

std::optional<BeyondSocket> beyond_socket(const Surface& ball, const Surface& socket,
                                          const FaceExtent& extent, double margin_mm) {
  const auto& [below, above] = extent.beyond_mm;
  const Interval along{extent.lo_mm - below - margin_mm, extent.hi_mm + above + margin_mm};
  const Vec3 d = ball.point - socket.point;
  // What lies between two planes and not within a sphere comes nearest to a place within it on the
  // sphere.
  if (!(d.norm() < socket.radius_mm)) return std::nullopt;
  const auto u = farthest_direction(d, socket.axis,
                                    {along.lo / socket.radius_mm, along.hi / socket.radius_mm});
  if (!u) return std::nullopt;
  return BeyondSocket{ball.radius_mm - (socket.radius_mm * *u - d).norm(), along};
}

std::optional<FacePairOverlap> face_pair_overlap(const Surface& a, const FaceExtent& extent_a,
                                                 const Surface& b, const FaceExtent& extent_b,
                                                 const Pose& X_BA, double margin_mm,
                                                 const std::array<PairOffsets, 2>* layers) {
  if (a.kind == SurfaceKind::kTorus || b.kind == SurfaceKind::kTorus)
    return tube_overlap(a, extent_a, b, extent_b, X_BA, margin_mm, layers);
  if (a.kind != b.kind || a.inward == b.inward) return std::nullopt;
  const Surface a_B = moved(a, X_BA);
  const Surface &convex = a.inward ? b : a_B, &hollow = a.inward ? a_B : b;
  const FaceExtent &along = a.inward ? extent_b : extent_a,
                   &of_hollow = a.inward ? extent_a : extent_b;
  std::optional<FacePairOverlap> found;
  if (a.kind == SurfaceKind::kSphere) {
    found = ball_in_socket(convex, hollow, of_hollow, margin_mm);
    if (found && !std::isfinite(found->near_hi_mm)) return std::nullopt;
    if (layers != nullptr && found) {
      std::array<PairOffsets, 2> of_ball = *layers;
      if (a.inward)
        for (PairOffsets& layer : of_ball) std::swap(layer.a_mm, layer.b_mm);
      found = ball_in_socket(convex, hollow, of_hollow, margin_mm, of_ball);
    }
  } else {
    const auto face = RoundFace::of(convex, {along.lo_mm, along.hi_mm});
    const auto wall = RoundFace::of(hollow, {of_hollow.lo_mm, of_hollow.hi_mm});
    if (!face || !wall) return std::nullopt;
    const double beyond = std::max(of_hollow.beyond_mm[0], of_hollow.beyond_mm[1]);
    const auto reach = round_reach(*face, *wall, beyond, kRoundAccuracy_mm);
    // As far beyond its own ends the convex face counts as near, too; a cone to its apex at most.
    RoundFace more = *face;
    more.extent_mm.lo -= margin_mm + along.beyond_mm[0];
    more.extent_mm.hi += margin_mm + along.beyond_mm[1];
    if (a.kind == SurfaceKind::kCone) more.extent_mm.lo = std::max(0.0, more.extent_mm.lo);
    const auto near = round_reach(more, *wall, margin_mm + beyond, kRoundAccuracy_mm);
    if (!reach || !near || !std::isfinite(near->reach_mm.hi)) return std::nullopt;
    found = FacePairOverlap{reach->reach_mm.lo, reach->reach_mm.hi, near->reach_mm.hi, reach->point,
                            -reach->outward};
  }
  // Now out of the convex face; B's own normal is asked for.
  if (found && !a.inward) found->normal_B = -found->normal_B;
  if (found && (layers == nullptr || a.kind != SurfaceKind::kSphere))
    found->of_layer_mm.fill({found->lo_mm, found->hi_mm});
  return found;
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
  if (std::fabs(slope) < kSlidingFitCosine) return bound;
  const double tilt = std::sqrt(std::max(0.0, 1.0 - slope * slope));
  if (surface.kind == SurfaceKind::kCylinder) {
    // The circles around the axis that may be near the bore, wherever the face ends.
    const auto& [below, above] = bore_extent.beyond_mm;
    const double beyond = query.margin_mm + std::max(below, above) + surface.radius_mm * tilt;
    const double z0 = (round.point - bore.point).dot(bore.direction);
    double farthest = 0.0;
    for (const double z : {bore_extent.lo_mm - beyond, bore_extent.hi_mm + beyond})
      farthest = std::max(farthest, bore.across(round.at((z - z0) / slope)).norm());
    bound.face_mm = bound.within_mm = farthest + surface.radius_mm - bore_radius;
    bound.holds_along_mm[a.inward ? 0 : 1] = {bore_extent.lo_mm - below - query.margin_mm,
                                              bore_extent.hi_mm + above + query.margin_mm};
    double at_ends = 0.0;
    for (const double z : {extent.lo_mm - extent.beyond_mm[0], extent.hi_mm + extent.beyond_mm[1]})
      at_ends = std::max(at_ends, bore.across(round.at(z)).norm());
    bound.along_mm = at_ends + surface.radius_mm - bore_radius;
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
  bound.along_mm = bound.face_mm;
  bound.holds_along_mm[a.inward ? 1 : 0] = {extent.lo_mm, extent.hi_mm};
  return bound;
}

}  // namespace mortise
