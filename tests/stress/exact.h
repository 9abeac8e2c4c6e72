#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/motion/motion.h"

// Geometry of the oracles in long double (unit round-off 5e-20 on x86): written from the
// definitions, sharing no code with the library that it judges.
namespace mortise::stress {

using Real = long double;

struct Point {
  Real x = 0, y = 0, z = 0;
};

inline Point point_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(Real s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real norm(const Point& a);

/// Rigid motion by a matrix that is orthogonal to long double.
struct Placement {
  Point row[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Point shift;

  Point turned(const Point& p) const { return {dot(row[0], p), dot(row[1], p), dot(row[2], p)}; }
  Point operator()(const Point& p) const { return turned(p) + shift; }
};

Placement placement_of(const Pose& X);
Placement inverse(const Placement& X);
Placement compose(const Placement& X, const Placement& Y);  ///< X after Y
/// Turn by the rotation vector w (Rodrigues), no shift.
Placement rotation_by(const Point& w);

/// The path of a motion from the fields that define it (start pose, velocities, axis), not from its
/// own pose_at().
Placement place_at(const Motion& motion, Real t);

/// Rotation vector of the turn from q0 to q1, |w| <= pi; at half a turn its sign is open.
Point turn_between(const Quat& q0, const Quat& q1);

using Corners = std::array<Point, 3>;

/// Does an edge of one pass through the inside of the other, or through its border between other
/// points? Touching without passing does not count.
bool passes_through(const Corners& a, const Corners& b);

struct Gap {
  Real mm = 0;
  Point on_a, on_b;
};

/// Distance of two triangles that do not pass through each other: least over corners against edges,
/// edges against edges, corners against faces.
Gap distance_of(const Corners& a, const Corners& b);

/// Distance of a point from a triangle.
Real distance_to(const Point& p, const Corners& t);

/// How often a closed surface winds about a point: sum of signed solid angles / 4 pi.
Real winding(const Point& p, const TriangleMesh& mesh);

}  // namespace mortise::stress
