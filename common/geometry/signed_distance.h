#pragma once
#include <cstdint>
#include <limits>

#include "common/geometry/solid.h"

namespace mortise {

struct NearestPoint {
  double distance_mm = std::numeric_limits<double>::infinity();  ///< unsigned
  Vec3 point = Vec3::Zero();  ///< nearest point of the mesh, part frame
  std::uint32_t triangle = 0;
};

/// Nearest point of the mesh to x (part frame) within limit_mm; triangle is kNone where there is
/// none. Ties go to the lower triangle id. Exact to rounding. O(log n) typical.
NearestPoint nearest_point(const Solid& solid, const Vec3& x,
                           double limit_mm = std::numeric_limits<double>::infinity());

/// Nearest point of one solid triangle to x; of its edges when it has no area.
Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Nearest point with its side. Part frame, mm.
struct SurfacePoint {
  double depth_mm = 0.0;             ///< positive inside the material, -distance outside
  Vec3 point = Vec3::Zero();         ///< nearest point of the mesh
  Vec3 outward = Vec3::UnitZ();      ///< unit, away from the material there (pseudonormal at edges)
  Vec3 face_normal = Vec3::UnitZ();  ///< unit normal of `triangle`; zero without area
  std::uint32_t triangle = 0;
};

/// Side by the angle-weighted pseudonormal (Baerentzen and Aanaes 2005), exact for closed manifold
/// meshes of one shell; all others ask inside(). O(log n) typical.
/// `near`: a triangle that is likely close to x, for example that of a neighbouring point. It makes
/// the query faster and never changes the answer.
SurfacePoint nearest_surface(const Solid& solid, const Vec3& x,
                             std::uint32_t near = Topology::kNone);

/// How often the surface winds around x: signed crossings of a ray through the tree, O(log n). For
/// a mesh whose edges balance; the lids of the cracks of another count with it. Whichever of two
/// neighbouring values on the surface itself.
int winding_number(const Solid& solid, const Vec3& x);

/// Is x inside the material? By the winding number >= 1; within a crack that is a guess. Meshes
/// without an inside sum solid angles over all triangles, a majority vote, O(n).
bool inside(const Solid& solid, const Vec3& x);

/// Negative inside.
double signed_distance_mm(const Solid& solid, const Vec3& x);

/// The slow twins: they look at every triangle.
NearestPoint nearest_point_brute_force(const TriangleMesh& mesh, const Vec3& x);
double winding_number_brute_force(const TriangleMesh& mesh, const Vec3& x);

}  // namespace mortise
