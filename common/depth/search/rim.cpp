#include "common/depth/search/rim.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mortise {
namespace {

// Sine of the angle by which a bore may be out of square to its plane.
constexpr double kSquare = 1e-9;

// Where the bore of one triangle ends in the plane of another, in the layer.
std::optional<Rim> rim_between(const Body& s, Layer layer, std::uint32_t bore, std::uint32_t flat) {
  const Surface* surface = Body::surface_of(s.face(bore), layer);
  if (surface == nullptr || !surface->inward || surface->kind != SurfaceKind::kCylinder ||
      s.face(flat).surface)
    return std::nullopt;
  const Vec3 n = s.normal(flat);
  const double along = n.dot(surface->axis), sine = n.cross(surface->axis).norm();
  if (n.isZero(0.0) || sine > kSquare) return std::nullopt;
  double reach_mm = surface->radius_mm;
  for (int k = 0; k < 3; ++k)
    reach_mm = std::max(reach_mm, (s.mesh->corner(flat, k) - surface->point).norm());
  const double height_mm = n.dot(s.mesh->corner(flat, 0) - surface->point) + 2.0 * sine * reach_mm +
                           std::max(0.0, Body::offset_of(s.face(flat), layer));
  Rim rim;
  rim.axis = along > 0.0 ? surface->axis : Vec3(-surface->axis);
  rim.center = surface->point + height_mm * rim.axis;
  rim.radius_mm = surface->radius_mm - Body::offset_of(s.face(bore), layer);
  return rim;
}

// The round surface's axis and its point on it, as seen from the rim.
struct Seen {
  double height_mm = 0.0;           // of the rim's centre, along the cone's axis
  Vec3 across = Vec3::Zero();       // from that axis to the rim's centre
  double cosine = 0.0, sine = 0.0;  // of the tilt of the axes
};

Seen seen(const Rim& rim, const Surface& round) {
  Seen at;
  const Vec3 from = rim.center - round.point;
  at.height_mm = from.dot(round.axis);
  at.across = from - at.height_mm * round.axis;
  at.cosine = rim.axis.dot(round.axis);
  at.sine = std::sqrt(std::max(0.0, 1.0 - at.cosine * at.cosine));
  return at;
}

}  // namespace

int rims_of(const Body& s, Layer layer, std::uint32_t triangle, std::span<Rim> rims) {
  // A face that is left out may move outward.
  if (layer == Layer::kMesh || s.sharp_left_out(triangle) > 0) return 0;
  std::size_t count = 0;
  const auto is_widened = [&](std::uint32_t but) {
    // By a third face that moves outward the triangle goes on past the rim.
    for (const std::uint32_t n : s.sharp_neighbours(triangle))
      if (n != but && Body::offset_of(s.face(n), layer) > 0.0) return true;
    return false;
  };
  for (const std::uint32_t other : s.sharp_neighbours(triangle)) {
    if (is_widened(other)) continue;
    auto rim = rim_between(s, layer, triangle, other);
    if (!rim) rim = rim_between(s, layer, other, triangle);
    if (rim && count < rims.size()) rims[count++] = *rim;
  }
  return static_cast<int>(count);
}

// A point of the rim's part is b + r u + z a with b the rim's centre, a its axis, u across it,
// r >= R and z <= 0. The tangent plane of the cone that faces u has the normal n = c e - s k, with
// k the cone's axis, c and s cosine and sine of its half angle, and e the direction of u across k.
// Below it the point is deep by
//   -n.(b - apex) - r n.u - z n.a;
// n.u > 0 and n.a <= 0 as long as the axes are tilted by less than the half angle, so that r = R
// and z = 0 are the worst. With d and h the way from the cone's axis to b and b's height,
//   -n.(b - apex) = -c e.d + s h,  n.u >= c cos(tilt) - s k.u,  |e.d - u.d| <= |d| (1 - cos(tilt)),
// and what is left is linear in u: -c d + R s k, of which u picks the part across a.
// A shaft is a cone of half angle 0 whose points are its radius higher; there n.a <= sin(tilt),
// which counts down to where the patch ends.
double depth_at_rim_mm(const Rim& rim, const Surface& round, double below_mm) {
  const Seen at = seen(rim, round);
  const bool shaft = round.kind == SurfaceKind::kCylinder;
  const double c = shaft ? 1.0 : std::cos(round.half_angle_rad);
  const double s = shaft ? 0.0 : std::sin(round.half_angle_rad);
  if (shaft ? !(std::fabs(at.cosine) > at.sine)
            : !(at.cosine > 0.0) || c * at.sine > s * at.cosine || c * at.cosine <= s * at.sine)
    return kInfinity;
  const Vec3 pull = -c * at.across + rim.radius_mm * s * round.axis;
  const double gain = (pull - pull.dot(rim.axis) * rim.axis).norm();
  const double cosine = std::fabs(at.cosine);
  const double raised = shaft ? round.radius_mm + std::max(0.0, below_mm) * at.sine : 0.0;
  return raised + s * at.height_mm + c * at.across.norm() * (1.0 - cosine) -
         rim.radius_mm * c * cosine + gain;
}

// Below one tangent plane depth is linear, so that on a straight line the ends are the worst. The
// plane that faces a point at one end faces it at the other but for the turn: e differs there by no
// more than turn / cos(tilt) =: q, which costs c |d| q, and of n.u half of c q^2.
double depth_at_rim_mm(const Rim& from, const Rim& to, const Surface& round, double below_mm,
                       double turn_rad, double spread_mm) {
  const double at_ends =
      std::max(depth_at_rim_mm(from, round, below_mm), depth_at_rim_mm(to, round, below_mm));
  if (turn_rad == 0.0 || !std::isfinite(at_ends)) return at_ends + spread_mm;
  const Seen at = seen(to, round);
  const bool shaft = round.kind == SurfaceKind::kCylinder;
  const double c = shaft ? 1.0 : std::cos(round.half_angle_rad);
  const double s = shaft ? 0.0 : std::sin(round.half_angle_rad);
  const double least = std::min(std::fabs(at.cosine), std::fabs(seen(from, round).cosine));
  const double q = turn_rad / least;
  if (c * (std::fabs(at.cosine) - 0.5 * q * q) <= s * at.sine) return kInfinity;
  return at_ends + c * (at.across.norm() * q + 0.5 * to.radius_mm * q * q) + spread_mm;
}

}  // namespace mortise
