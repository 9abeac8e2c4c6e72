#pragma once
#include "tests/unit/ccd/shapes.h"

/// Random closed meshes of about unit size, few triangles: an oracle asks every pair of them.
namespace mortise::stress {

/// Sphere whose corners stand at random radii: not convex, star-shaped.
TriangleMesh star_mesh(std::mt19937_64& random);
TriangleMesh torus_mesh(double radius, double thickness, int around, int across);
/// Random tetrahedra, each closed, through one another.
TriangleMesh soup_mesh(std::mt19937_64& random, int count);
/// Turned boxes through one another.
TriangleMesh boxes_mesh(std::mt19937_64& random, int count);
TriangleMesh gear_mesh(double radius, int teeth, double thickness);
/// Every triangle cut in four at the middles of its edges; the same surface up to rounding.
TriangleMesh refined(const TriangleMesh& mesh);

inline constexpr int kShapes = 7;
const char* shape_name(int kind);
/// kind in [0, kShapes): bar, convex, star, torus, soup, boxes, gear.
SolidPtr random_shape(std::mt19937_64& random, int kind);

/// Any direction, any angle up to the given one.
Vec3 random_turn(std::mt19937_64& random, double largest_rad);
double uniform(std::mt19937_64& random, double lo, double hi);
Vec3 random_vector(std::mt19937_64& random, double reach_mm);

}  // namespace mortise::stress
