#pragma once
#include <array>
#include <vector>

#include "common/depth/body.h"

namespace mortise {

/// Where a part of a body's surface may be, seen from the other body K: the hull of a few points,
/// thickened. Frame K, mm. In a tick the points are those of both ends of a time interval.
struct Patch {
  struct Plus {
    Vec3 normal = Vec3::Zero();
    double offset_mm = 0.0;
    bool flat = false;  ///< of a plane: its normal does not turn over the patch
  };
  static constexpr int kMost = 32;  ///< eight planes leave a triangle 11 corners, at two ends
  std::array<Vec3, kMost> points;
  int count = 0;
  Vec3 normal = Vec3::Zero();  ///< outward normal of the surface
  double turn_rad = 0.0;       ///< the normal turns by no more than this over the patch
  double bulge_mm = 0.0;       ///< the surface leaves the hull by no more than this ...
  bool bulges_outward = true;  ///< ... outward (convex face) or inward (concave) ...
  bool bulges_both = false;    ///< ... or both ways (torus)
  double slip_mm = 0.0;        ///< and sideways on a cone, across its axis
  double spread_mm = 0.0;      ///< and in any direction (paths of rotation, neighbours left out)
  static constexpr int kMostPlus = 1 + static_cast<int>(Body::kMostSharp);  ///< own and neighbours
  std::array<Plus, kMostPlus> plus;  ///< outward offsets: of the face, and of sharp neighbours
  int plus_count = 0;
  bool plus_is_own = false;      ///< plus[0] is of the face itself
  double motion_turn_rad = 0.0;  ///< part of turn_rad that is owed to a motion
  /// A cylinder bulges and is offset only across its axis. Zero: no cylinder.
  Vec3 axis = Vec3::Zero();
  /// A cone bulges only across its axis, but is offset along its normal. Zero: no cone.
  Vec3 cone_axis = Vec3::Zero();
  /// On a convex round face: circles whose hull contains all of the patch, its own offset included,
  /// but its neighbours' offsets and spread, so that its extreme in any direction is known. At both
  /// ends of an interval.
  struct Circle {
    Vec3 center = Vec3::Zero(), axis = Vec3::UnitZ();
    double radius_mm = 0.0;  ///< about the axis
    double ball_mm = 0.0;    ///< of balls all along the circle: of a ball, of a torus
    /// How far it reaches along a unit vector, from its centre.
    double reach_mm(const Vec3& along) const;
  };
  std::array<Circle, 4> circles;
  int circle_count = 0;
  Vec3 center = Vec3::Zero();  ///< a point of the layer's surface (at the start of the interval)
  double radius_mm = 0.0;      ///< of all points about center, thickness included

  /// Largest share of an offset or bulge of the face itself that counts against a facet.
  double across(const Vec3& facet_normal, double facet_turn_rad) const;
  /// What the offsets of sharp neighbours add.
  double neighbours_beyond(const Vec3& facet_normal, double facet_turn_rad) const;
  /// How much of the bulge counts against a facet.
  double bulge_beyond(const Vec3& facet_normal, double facet_turn_rad) const;
  /// How far beyond the hull the patch may reach against a facet of K with this outward normal.
  double beyond(const Vec3& facet_normal, double facet_turn_rad) const;
  /// How far the patch may reach below the plane through `point`, by its points or by its circles.
  double depth_below_plane(const Vec3& facet_normal, const Vec3& point,
                           double facet_turn_rad) const;
  /// Largest thickness in any direction.
  double thickness() const;
};

/// A flat piece of a triangle of S; corners in S.
struct Piece {
  std::array<Vec3, 3> corners;
  std::uint32_t triangle = 0;
};

/// A piece of S in a layer, independent of its pose: made once for several poses. Frame S, mm; the
/// names are those of Patch. The polygon is empty when the neighbours' surfaces cut all of it away.
struct PieceShape {
  std::vector<Vec3> polygon;
  Vec3 center = Vec3::Zero(), normal = Vec3::Zero(), axis = Vec3::Zero();
  double turn_rad = 0.0, bulge_mm = 0.0, slip_mm = 0.0, spread_mm = 0.0;
  bool bulges_outward = true, bulges_both = false, plus_is_own = false, on_cylinder = false,
       on_cone = false;
  std::array<Patch::Plus, Patch::kMostPlus> plus;
  int plus_count = 0;
  std::array<Patch::Circle, 2> circles;
  int circle_count = 0;

  bool empty() const { return polygon.empty(); }
};
PieceShape shape_of(const Body& s, Layer layer, const Piece& piece);

/// A point of the layer's surface over a mesh point of a triangle; cut back where a sharp neighbour
/// moves inward. Part frame.
Vec3 on_layer(const Body& s, Layer layer, std::uint32_t triangle, const Vec3& x);

/// The patch of a piece of S in a layer, in frame K. Without points when the neighbours' surfaces
/// cut all of it away.
Patch make_patch(const PieceShape& shape, const Pose& X_KS);
Patch make_patch(const Body& s, Layer layer, const Piece& piece, const Pose& X_KS);

/// The same over a motion from X_KS0 to X_KS1 on which every point of the piece stays within
/// spread_mm of the straight line between its ends, and normals turn by no more than turn_rad.
Patch make_swept_patch(const PieceShape& shape, const Pose& X_KS0, const Pose& X_KS1,
                       double spread_mm, double turn_rad);

/// Halves a piece across the edge that matters: on a curved face lengths around it weigh more.
std::array<Piece, 2> split(const Body& s, Layer layer, const Piece& piece);

}  // namespace mortise
