#pragma once
#include <vector>

#include "common/geometry/solid.h"
#include "common/math/interval.h"

namespace mortise {

/// Where the true surface may lie above each triangle, outward positive, mm, estimated from the
/// mesh alone (README, section 1); never a guarantee. Flat groups of triangles are facets; facets
/// of widths w1, w2 that meet smoothly (exterior angle phi up to kSmoothEdge_rad) bend by phi over
/// (w1 + w2)/2, so that this one hides (w1/2) tan(phi w1 / (w1 + w2) / 2): the sagitta, exact for a
/// cylinder of any steps. Two transverse directions add up. Convex bends are offsets outward,
/// concave ones inward.
///
/// Not detected: a curve drawn with facets that meet at more than 35 degrees (a hexagon stays a
/// hexagon), and a curve beside a facet more than four times as wide, which counts as a plane
/// tangent to it. Without kEstimatedDeviationFactor. Deterministic, O(n log n). quantum_mm:
/// rounding of the file's coordinates.
std::vector<Interval> estimated_deviation_mm(const Solid& solid, double quantum_mm = 0.0);

/// The estimate as a band uses it: times kEstimatedDeviationFactor, each end rounded outward to the
/// preferred numbers R10 (1, 1.25, 1.6, 2, ...), so that few distinct faces result.
Interval coarsened(const Interval& estimate_mm);

}  // namespace mortise
