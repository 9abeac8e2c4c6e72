#pragma once
#include <random>

#include "common/ccd/first_contact.h"
#include "common/math/rotation.h"

namespace mortise::testing {

/// Closed meshes with outward triangles, and how to ask about them.
TriangleMesh box_mesh(const Vec3& size, const Vec3& center = Vec3::Zero());
TriangleMesh sphere_mesh(double radius, int around, int down);
/// Prism of n sides about z, corners at radius and angle k 2 pi / n.
TriangleMesh prism_mesh(double radius, int n, double z0, double z1);
/// Tube with n-sided bore, corners at `inner`, and outer radius `outer`.
TriangleMesh tube_mesh(double inner, double outer, int n, double z0, double z1);
TriangleMesh tetrahedron_mesh(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Hull of random points on an ellipsoid-like cloud: a convex polyhedron with about 2n triangles.
TriangleMesh convex_mesh(std::mt19937_64& random, int n);
void append(TriangleMesh& to, const TriangleMesh& from);
TriangleMesh inside_out(TriangleMesh mesh);
TriangleMesh scaled(TriangleMesh mesh, double factor);

SolidPtr solid(TriangleMesh mesh);

Pose shift(double x, double y, double z);
Pose turn(const Vec3& rotation_rad, const Vec3& p_mm = Vec3::Zero());
Pose random_pose(std::mt19937_64& random, double reach_mm, double largest_angle_rad);

/// Moves X0 to X1 with the origin as reference point.
Motion move(const Pose& X0, const Pose& X1);
Motion slide(const Vec3& from, const Vec3& to);

ContactQuery query(const SolidPtr& a, const Motion& motion_a, const SolidPtr& b,
                   const Motion& motion_b);
FirstContact solve(const SolidPtr& a, const Motion& motion_a, const SolidPtr& b,
                   const Motion& motion_b = Motion{});
FirstContact solve(const ContactQuery& query);

}  // namespace mortise::testing
