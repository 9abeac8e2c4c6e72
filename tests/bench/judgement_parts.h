#pragma once
#include <string>
#include <vector>

#include "common/evaluation/deviation.h"
#include "common/geometry/solid.h"

/// Parts of the judgement benchmark: every curved corner lies on the true surface.
namespace mortise::bench {

/// A part whose true surfaces are all known. `features` has every curved face and, for prismatic
/// parts, the planes that a statement speaks of; all are checked against the mesh.
struct JudgedPart {
  SolidPtr solid;
  std::vector<Feature> features;
  int facets = 0;  ///< around; 0: planar
};

/// Corners of a full circle.
struct Around {
  int facets = 32;
  double phase_rad = 0.0;
};

/// A closed profile in the (r, z) half plane, counter-clockwise, turned about z. A piece ends where
/// the next begins; a piece with a surface becomes a feature. r = 0 is on the axis.
class Turning {
 public:
  struct Point {
    double r_mm, z_mm;
  };
  explicit Turning(const Point& start) { points_.push_back(start); }
  Turning& line_to(const Point& end, int rows = 1);
  /// Arc about (0, center_z_mm), angles from the -z axis; the radius is that of the last point.
  Turning& arc(double center_z_mm, double from_rad, double to_rad, int rows);
  Turning& is(const std::string& name, const Surface& surface);  ///< of the last piece
  JudgedPart turn(const Around& around) &&;

 private:
  struct Piece {
    std::size_t first_edge = 0, end_edge = 0;
    std::string name;
    Surface surface;
  };
  std::vector<Point> points_;
  std::vector<Piece> pieces_;
};

Surface cylinder_surface(double radius_mm, bool inward);
Surface sphere_surface(const Vec3& center, double radius_mm, bool inward);
/// Cone through (r0, z0) and (r1, z1) about z; the radii differ.
Surface cone_surface(const Turning::Point& p0, const Turning::Point& p1, bool inward);

/// Shaft with flat ends, or a conical one; z from z0 to z1.
struct Frustum {
  double r0_mm = 10.0, z0_mm = 0.0, r1_mm = 10.0, z1_mm = 20.0;
};
JudgedPart make_shaft(const Frustum& frustum, int rows, const Around& around);
/// Ring with such a hole, cylindrical outside.
JudgedPart make_ring(const Frustum& hole, double outer_mm, int rows, const Around& around);
/// Ball about the origin.
JudgedPart make_ball(double radius_mm, const Around& around);
/// Cylindrical block with a spherical cavity about the origin, open above z = rim.
JudgedPart make_socket(double radius_mm, double rim_z_mm, double outer_mm, const Around& around);
/// Box about the origin; features left, right (-x, +x), bottom (-y), n x n squares a face.
JudgedPart make_block(const Vec3& half_mm, int n);
/// Block with a slot of half width s along z, open at +y, floor at y = 0; features left, right
/// (walls at -s, +s) and floor.
struct Slot {
  double half_width_mm, depth_mm, half_length_mm, wall_mm;
};
JudgedPart make_slot(const Slot& slot);

/// Largest distance of the mesh from its curved surfaces, mm: the chord error a designer would
/// state.
double chord_error_mm(const JudgedPart& part);

}  // namespace mortise::bench
