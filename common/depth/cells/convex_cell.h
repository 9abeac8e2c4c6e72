#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/depth/cells/hull_corners.h"
#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// {x : n · x <= c}, n a unit vector. mm.
struct HalfSpace {
  Vec3 n = Vec3::UnitZ();
  double c_mm = 0.0;
};

/// Directions across an axis, unit: all, or those from one to another past the middle of both.
struct Arc {
  bool whole = true;
  Vec3 from = Vec3::Zero(), middle = Vec3::Zero(), to = Vec3::Zero();
  double cosine = -1.0;  ///< of half the angle between both ends
  Arc() = default;
  Arc(const Vec3& first, const Vec3& halfway, const Vec3& last);

  bool holds(const Vec3& d) const { return whole || d.dot(middle) >= cosine * d.norm(); }
  /// The largest u . d over all of them, d across the axis: convex in d.
  double most(const Vec3& d) const {
    return holds(d) ? d.norm() : std::max(from.dot(d), to.dot(d));
  }
  /// The u of it; otherwise: where d is zero.
  Vec3 farthest(const Vec3& d, const Vec3& otherwise) const;
};

/// A convex body in the frame of its part, mm: one of revolution, a piece of such a one, or a
/// polytope.
struct ConvexCell {
  /// A circle about the axis, `z_mm` along it from `point`.
  struct Circle {
    double z_mm = 0.0, r_mm = 0.0;
  };
  bool round = false;
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();
  Vec3 across[2] = {Vec3::UnitX(), Vec3::UnitY()};  ///< unit, at right angles to the axis
  std::vector<Circle> circles;  ///< round: the body is their hull; z ascends, r is concave over z
  /// Between the circle of this number and the next one the body bulges out to a ball about the
  /// axis. Such bodies are whole.
  struct Zone {
    std::size_t circle = 0;
    double z_mm = 0.0, r_mm = 0.0;  ///< of the ball: its middle along the axis, its radius
  };
  std::vector<Zone> zones;

  Arc arc;  ///< round, not whole: the body is the hull of these points of the circles

  HullCorners corners;  ///< polytope: the body is their hull, and that of `pieces`
  /// Its edges, by corner. There may be more, none is missing.
  std::vector<std::array<std::uint16_t, 2>> edges;
  /// Of a prism with round sides along `axis`, of one length. Its edges along the axis are named.
  std::vector<ConvexCell> pieces;

  std::vector<HalfSpace> faces;  ///< the plane ones; each touches the body
  Vec3 middle = Vec3::Zero();    ///< a point inside

  /// Is there a zone between this circle and the next one?
  bool bulges(std::size_t circle) const {
    return std::any_of(zones.begin(), zones.end(),
                       [&](const Zone& zone) { return zone.circle == circle; });
  }
  /// Largest n · x over the body; of a point where it is reached. n need not be a unit vector.
  double support_mm(const Vec3& n) const;
  Vec3 farthest(const Vec3& n) const;
  /// Largest distance of a point of the body from x; of a prism with round sides, no less than it.
  double farthest_from_mm(const Vec3& x, Vec3& at) const;
  /// The middle of all that is no more than slack_mm less far. n: a unit vector.
  Vec3 farthest_middle(const Vec3& n, double slack_mm) const;
  /// Corners of it; some of a disc.
  std::vector<Vec3> around_farthest(const Vec3& n, double slack_mm) const;
  /// A point of the body near x; of one of revolution the nearest, of a polytope about that.
  Vec3 near(const Vec3& x) const;

  /// Sets `faces` to those with these normals, outward unit vectors.
  void set_faces(std::span<const Vec3> normals);

 private:
  bool is_zone(const Zone& zone, double z_mm) const {
    return circles[zone.circle].z_mm <= z_mm && z_mm <= circles[zone.circle + 1].z_mm;
  }
  /// Of the ball of a zone the point along d; nullopt: it is not of the zone. d: not zero.
  std::optional<Vec3> on_zone(const Zone& zone, const Vec3& d) const;
  Vec3 nearest_of_round(const Vec3& x) const;
};

/// A straight line in the half plane beside an axis: what lies below it is along * z + off * r <=
/// c. (along, off) is a unit vector, off >= 0.
struct MeridianLine {
  double along = 0.0, off = 1.0, c_mm = 0.0;
};

/// A ball about an axis, its middle z_mm along it.
struct MeridianBall {
  double z_mm = 0.0, r_mm = 0.0;
};

/// The body of revolution below all lines and within all balls; nullopt: it is empty. The lines
/// must bound it.
std::optional<ConvexCell> round_cell(const Vec3& point, const Vec3& axis,
                                     std::span<const MeridianLine> lines,
                                     std::span<const MeridianBall> balls = {});

/// The polytope within all half-spaces, which must bound it; nullopt: it is empty. O(n⁴).
std::optional<ConvexCell> polytope_cell(std::span<const HalfSpace> planes);

/// The prism over a convex polygon in the plane of frame[0] and frame[1], counter-clockwise,
/// between two heights along frame[2]. The frame is orthonormal; nullopt: it is empty.
std::optional<ConvexCell> prism_cell(const std::array<Vec3, 3>& frame,
                                     const std::vector<Vec2>& polygon, const Interval& along);

}  // namespace mortise
