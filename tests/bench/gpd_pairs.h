#pragma once
#include <cstdint>

#include "common/geometry/solid.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

/// Random pairs that overlap, and the exact depth of the convex ones.
namespace mortise::bench {

struct GpdPair {
  SolidPtr a, b;
  Pose X_WA, X_WB;
};

/// Two hulls of 8 to 21 random points; the same on every run.
GpdPair draw_convex_pair(std::uint64_t seed);
/// Hooks, slots, plates with bores, keys and pins; at least one is not convex.
GpdPair draw_hollow_pair(std::uint64_t seed);

/// The shortest translation that parts two convex meshes: least over all facets that their
/// Minkowski difference can have, the normals of faces and the crosses of all pairs of edges, of
/// how far they overlap along it. Shares nothing with the engine but the meshes.
double minkowski_depth_mm(const GpdPair& pair);

}  // namespace mortise::bench
