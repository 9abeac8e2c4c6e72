#pragma once
#include <optional>

#include "common/depth/answer/inner_overlap.h"

namespace mortise {

/// The overlap over all points of two convex parts, without offsets, by cutting planes: a point of
/// a part is no deeper than its distance from any plane that supports the part, so the largest sum
/// of two depths is bounded by a linear program over such planes (README, section 1). nullopt: a
/// part is not convex but for rounding, or no point is in both. Begins at start_W, a point near
/// the overlap; ends where the bracket is no wider than accuracy_mm, or after some 60 planes.
/// Adds to `evaluations`, two for each point asked.
std::optional<InnerOverlap> convex_overlap(const PairFrame& pair, const Vec3& start_W,
                                           double accuracy_mm, std::uint64_t& evaluations);

/// A point deeper than deeper_mm in either part, by the same planes: where the sum of both depths
/// is largest it may lie on the surface of one. nullopt as above, or none was found.
std::optional<InnerOverlap> convex_inside_both(const PairFrame& pair, const Vec3& start_W,
                                               double deeper_mm, std::uint64_t& evaluations);

/// The same of the bodies of a layer, bounded from above by one linear program over all their moved
/// faces. nullopt: a part is not convex, has faces that are not plane, or very many.
std::optional<double> most_of_convex_layer_mm(const PairFrame& pair, Layer layer);

}  // namespace mortise
