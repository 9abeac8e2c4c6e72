#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "common/math/types.h"

namespace mortise {

using Loop = std::vector<Vec2>;  ///< closed polygon, the last corner joins the first

/// Twice the signed area; positive counter-clockwise.
double twice_area(const Loop& loop);

/// Cuts a polygon with holes into triangles over its own corners (no new ones): indices into outer
/// followed by the holes in their order. outer runs counter-clockwise, holes clockwise; loops must
/// not touch. Holes are joined by shortest free bridges, ears are cut shortest first. An error when
/// the polygon is not simple: the triangles would not have its area. O(n^2) typical.
Result<std::vector<std::array<std::uint32_t, 3>>> triangulate(const Loop& outer,
                                                              const std::vector<Loop>& holes);

}  // namespace mortise
