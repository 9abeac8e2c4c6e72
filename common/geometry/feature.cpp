#include "common/geometry/feature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/geometry/surface_at.h"

namespace mortise {
namespace {

// How closely the least distance to a torus is found, as a share of how deep a triangle is.
constexpr double kTorusShare = 1e-2;

// Rounding of a distance, as a share of it.
constexpr double kRoundingShare = 1e-15;
// The same of a least distance from a cone, as a share of how far the triangle is from the apex.
constexpr double kConeRounding = 1e-14;

using Corners = std::array<Vec3, 3>;

// Distance of a point from a triangle of its own plane, whose normal is given; the triangle may be
// as thin as a line.
double distance_to_flat_triangle(const Vec3& x, const Vec3& normal, const Corners& c) {
  double least = std::numeric_limits<double>::infinity();
  bool left = true, right = true;
  for (int k = 0; k < 3; ++k) {
    const Vec3 from = c[k] - x, edge = c[(k + 1) % 3] - c[k];
    const double side = from.cross(edge).dot(normal);
    left &= side >= 0.0;
    right &= side <= 0.0;
    const double length2 = edge.squaredNorm();
    const double share = length2 > 0.0 ? std::clamp(-from.dot(edge) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, (from + share * edge).norm());
  }
  return left || right ? 0.0 : least;
}

// A triangle cut in two across its longest edge.
std::array<Corners, 2> halves_of(const Corners& c) {
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if ((c[(k + 1) % 3] - c[k]).squaredNorm() > (c[(longest + 1) % 3] - c[longest]).squaredNorm())
      longest = k;
  const Vec3 half = 0.5 * (c[longest] + c[(longest + 1) % 3]);
  const Vec3& apex = c[(longest + 2) % 3];
  return {Corners{c[longest], half, apex}, Corners{half, c[(longest + 1) % 3], apex}};
}

// Least r cos(half angle) - z sin(half angle) over an edge: the distance from the cone where its
// generator is nearest, and no more than it behind the apex. r is the root of a square of the place
// along the edge, z is linear.
double least_over_edge(const SurfaceAt& at, double half_angle_rad, const Vec3& a, const Vec3& b) {
  const double cosine = std::cos(half_angle_rad), sine = std::sin(half_angle_rad);
  const auto value = [&](double share) {
    const SurfaceAt::View v = at.view_from_axis(a + share * (b - a));
    return v.r_mm * cosine - v.z_mm * sine;
  };
  const Vec3& axis = at.surface().axis;
  const Vec3 from = a - at.surface().point, along = b - a;
  const double rise = along.dot(axis);
  const Vec3 across = along - rise * axis, off = from - from.dot(axis) * axis;
  const double length = across.norm();
  double least = std::min(value(0.0), value(1.0));
  const double steep = cosine * length, falls = sine * rise;
  if (!(steep > std::fabs(falls))) return least;  // it grows or falls all along
  const double nearest = -off.dot(across) / (length * length);
  const double least_r = (off + nearest * across).norm();
  const double share =
      nearest + falls * least_r / (length * std::sqrt(steep * steep - falls * falls));
  if (share > 0.0 && share < 1.0) least = std::min(least, value(share));
  return least;
}

// The same over a triangle. In its plane the function has a smooth minimum only where the plane is
// parallel to a tangent plane, and then all along a generator, which ends on an edge. What is left
// is the axis, where r has a corner.
double least_over_cone(const Surface& s, const Corners& c) {
  const SurfaceAt at(s);
  double least = std::numeric_limits<double>::infinity(), size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    least = std::min(least, least_over_edge(at, s.half_angle_rad, c[k], c[(k + 1) % 3]));
    size = std::max(size, (c[k] - s.point).norm());
  }
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
  const double leans = normal.dot(s.axis);
  if (leans != 0.0) {
    const Vec3 x = s.point + normal.dot(c[0] - s.point) / leans * s.axis;
    if (distance_to_flat_triangle(x, normal, c) == 0.0)
      least = std::min(least, -std::sin(s.half_angle_rad) * (x - s.point).dot(s.axis));
  }
  return least - kConeRounding * size;
}

// Is every point of a triangle nearest to a generator, and not to the apex? Its ball is.
bool in_front(const SurfaceAt& at, const Corners& c) {
  const Vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
  double reach = 0.0;
  for (const Vec3& x : c) reach = std::max(reach, (x - middle).norm());
  const SurfaceAt::View v = at.view_from_axis(middle);
  return at.along_generator(v.z_mm, v.r_mm) >= reach;
}

struct LeastSearch {
  const SurfaceAt at;
  double accuracy_mm;
  double best;  // least value met so far
};

// Lower bound of the outside distance over a triangle, within accuracy: the tangent at the middle
// bounds a convex function from below, and halving the longest edge tightens it quadratically.
double least_over(LeastSearch& search, const Corners& c, int depth) {
  const Vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
  const double at_middle = search.at.outside_mm(middle);
  const Vec3 slope = search.at.outside_normal(middle);
  double bound = std::numeric_limits<double>::infinity();
  double reach = 0.0;
  search.best = std::min(search.best, at_middle);
  for (const Vec3& corner : c) {
    bound = std::min(bound, at_middle + slope.dot(corner - middle));
    reach = std::max(reach, (corner - middle).norm());
    search.best = std::min(search.best, search.at.outside_mm(corner));
  }
  // A distance changes by no more than the path walked, whatever the curvature.
  bound = std::max(at_middle - reach, bound - search.at.surface().concave_bend_mm(middle, c, 0.0));
  if (bound >= search.best - search.accuracy_mm || depth == 0) return bound;
  const auto halves = halves_of(c);
  return std::min(least_over(search, halves[0], depth - 1),
                  least_over(search, halves[1], depth - 1));
}

// Is the outside distance nowhere less than the limit? By tangents, halving only where they leave
// it open.
bool nowhere_below(const SurfaceAt& s, double limit_mm, const Corners& c, int depth) {
  const Vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
  const double at_middle = s.outside_mm(middle);
  if (at_middle < limit_mm) return false;
  const Vec3 slope = s.outside_normal(middle);
  double bound = std::numeric_limits<double>::infinity(), reach = 0.0;
  for (const Vec3& corner : c) {
    bound = std::min(bound, at_middle + slope.dot(corner - middle));
    reach = std::max(reach, (corner - middle).norm());
  }
  bound -= s.surface().concave_bend_mm(middle, c, 0.0);
  if (std::max(bound, at_middle - reach) >= limit_mm) return true;
  if (depth == 0) return false;
  const auto halves = halves_of(c);
  return nowhere_below(s, limit_mm, halves[0], depth - 1) &&
         nowhere_below(s, limit_mm, halves[1], depth - 1);
}

}  // namespace

double Surface::signed_distance_mm(const Vec3& x) const {
  return SurfaceAt(*this).signed_distance_mm(x);
}

Vec3 Surface::outward_normal(const Vec3& x) const { return SurfaceAt(*this).outward_normal(x); }

double Surface::curvature_bound(const Vec3& x) const {
  switch (kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere:
      return 1.0 / radius_mm;
    case SurfaceKind::kCone: {
      // Meusnier at the foot of x: the circle of radius r there is tilted by the half angle.
      const SurfaceAt at(*this);
      const SurfaceAt::View view = at.view_from_axis(x);
      const double along = at.along_generator(view.z_mm, view.r_mm);
      const double r = along * std::sin(half_angle_rad);
      return r > 0.0 ? std::cos(half_angle_rad) / r : std::numeric_limits<double>::infinity();
    }
    case SurfaceKind::kTorus:
      // On the inner side of the tube it bends around the axis.
      return std::max(1.0 / tube_radius_mm, radius_mm > tube_radius_mm
                                                ? 1.0 / (radius_mm - tube_radius_mm)
                                                : std::numeric_limits<double>::infinity());
    case SurfaceKind::kPlane:
    case SurfaceKind::kUnknown:
      break;
  }
  return 0.0;
}

// Around the axis it bends by no more than 1 / distance from the axis, and only what points differ
// by in that direction counts: t at the middle, elsewhere turned by their angle about the axis.
double Surface::concave_bend_mm(const Vec3& middle, std::span<const Vec3> points,
                                double more_mm) const {
  if (kind != SurfaceKind::kTorus) return 0.0;
  const SurfaceAt::View view = SurfaceAt(*this).view_from_axis(middle);
  const Vec3 t = axis.cross(view.radial);
  double reach_mm = more_mm, around_mm = more_mm;
  for (const Vec3& x : points) {
    reach_mm = std::max(reach_mm, (x - middle).norm() + more_mm);
    around_mm = std::max(around_mm, std::fabs((x - middle).dot(t)) + more_mm);
  }
  const double nearest_mm = view.r_mm - reach_mm;
  if (nearest_mm >= radius_mm) return 0.0;
  if (!(nearest_mm > 0.0)) return 2.0 * reach_mm;
  const double width_mm = std::min(reach_mm, around_mm + reach_mm * around_mm / nearest_mm);
  return std::min(2.0 * reach_mm, 0.5 * width_mm * width_mm / nearest_mm);
}

Interval Surface::signed_distance_range_mm(const Vec3& a, const Vec3& b, const Vec3& c,
                                           double accuracy_mm) const {
  MORTISE_CHECK(a.allFinite() && b.allFinite() && c.allFinite() && accuracy_mm > 0.0,
                "corners must be finite, the accuracy positive");
  constexpr int kHalvings = 24;  // 4096 pieces along each side
  const SurfaceAt at(*this);
  const double da = at.outside_mm(a), db = at.outside_mm(b), dc = at.outside_mm(c);
  if (kind == SurfaceKind::kPlane || kind == SurfaceKind::kUnknown)
    return {std::min({da, db, dc}), std::max({da, db, dc})};
  Corners corners{a, b, c};
  if (kind == SurfaceKind::kCylinder)  // height does not count: a flat figure needs fewer halvings
    for (Vec3& corner : corners) corner -= (corner - point).dot(axis) * axis;
  double least = 0.0;
  if (kind == SurfaceKind::kCylinder) {
    least = distance_to_flat_triangle(point, axis, corners) * (1.0 - kRoundingShare) -
            radius_mm * (1.0 + kRoundingShare);
  } else if (kind == SurfaceKind::kCone && in_front(at, corners)) {
    least = least_over_cone(*this, corners);
  } else {
    // Tangents of a torus are off by its bend: closing them far below the sagitta costs the most.
    double accuracy = accuracy_mm;
    if (kind == SurfaceKind::kTorus) {
      const double sagitta = std::min({da, db, dc}) - at.outside_mm((a + b + c) / 3.0);
      accuracy = std::max(accuracy, kTorusShare * std::fabs(sagitta));
    }
    LeastSearch search{at, accuracy, std::min({da, db, dc})};
    least = least_over(search, corners, kHalvings);
  }
  // A convex function is largest at a corner.
  const double most =
      std::max({da, db, dc}) + concave_bend_mm((a + b + c) / 3.0, Corners{a, b, c}, 0.0);
  return inward ? Interval{-most, -least} : Interval{least, most};
}

bool Surface::is_cap(const Vec3& a, const Vec3& b, const Vec3& c, double near_mm) const {
  if (kind != SurfaceKind::kCylinder && kind != SurfaceKind::kCone && kind != SurfaceKind::kTorus)
    return false;
  const auto on_circle = [&](const Vec3& x, const Vec3& y) {
    const double up_x = (x - point).dot(axis), up_y = (y - point).dot(axis);
    const double out_x = (x - point - up_x * axis).norm(), out_y = (y - point - up_y * axis).norm();
    return std::fabs(up_x - up_y) <= near_mm && std::fabs(out_x - out_y) <= near_mm;
  };
  return on_circle(a, b) && on_circle(b, c) && on_circle(c, a);
}

bool Surface::stays_below_mm(const Vec3& a, const Vec3& b, const Vec3& c, double limit_mm) const {
  constexpr int kHalvings = 24;  // pieces of 6e-8 of the triangle: what is open then counts as no
  if (std::max({signed_distance_mm(a), signed_distance_mm(b), signed_distance_mm(c)}) > limit_mm)
    return false;
  if (kind == SurfaceKind::kPlane || kind == SurfaceKind::kUnknown) return true;
  if (!inward)
    return std::max({signed_distance_mm(a), signed_distance_mm(b), signed_distance_mm(c)}) +
               concave_bend_mm((a + b + c) / 3.0, Corners{a, b, c}, 0.0) <=
           limit_mm;
  if (kind == SurfaceKind::kCylinder) return signed_distance_range_mm(a, b, c).hi <= limit_mm;
  return nowhere_below(SurfaceAt(*this), -limit_mm, {a, b, c}, kHalvings);
}

}  // namespace mortise
