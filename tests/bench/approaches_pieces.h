#pragma once
#include <optional>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/math/pose.h"

/// Measures of an overlap of two parts that are given as convex pieces, exact to rounding. Shares
/// no code with the engine.
namespace mortise::bench {

/// Convex pieces with disjoint interiors, closed meshes, in one frame.
using Pieces = std::vector<TriangleMesh>;

Pieces placed(const Pieces& pieces, const Pose& X);

/// Volume of the intersection, mm³: the polytope within the planes of each two pieces, face by
/// face.
double common_volume_mm3(const Pieces& a, const Pieces& b);

/// The least translation of A that parts it from B: the point outside of all Minkowski differences
/// of two pieces that is nearest to the origin, by branch and bound over their faces. nullopt: more
/// nodes than that. World frame.
std::optional<double> translational_depth_mm(const Pieces& a, const Pieces& b,
                                             long long most_nodes = 400'000);

/// A polygonal ring of n corners (as shapes::ring) in n pieces.
Pieces ring_pieces(double hole_mm, double outer_mm, double z0_mm, double z1_mm, int n,
                   double phase_rad);
/// A block with a slot (as shapes::u_slot) in three pieces.
Pieces slot_pieces(double w_mm, double s_mm, double h_mm, double floor_mm, double z0_mm,
                   double z1_mm);

}  // namespace mortise::bench
