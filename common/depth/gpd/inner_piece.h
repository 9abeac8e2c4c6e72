#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "common/depth/cells/convex_cell.h"
#include "common/geometry/solid.h"
#include "common/math/pose.h"

namespace mortise::gpd {

/// A polytope that lies within a part, around x (part frame): no triangle of the part reaches into
/// it, and its middle is inside (README, section 7). nullopt: x is not inside, or it would take
/// more planes than that. O(n log n).
std::optional<ConvexCell> inner_piece(const Solid& part, const Vec3& x, std::size_t most_planes);

struct PiecesQuery {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  Pose X_WA, X_WB;
  std::span<const Vec3> points_W;  ///< of surfaces that lie in the other part, deepest first
  std::size_t most_points = 2, most_planes = 16;
};

/// A lower bound of the path that some point of either part must take, whatever motion parts them:
/// the depth of a piece of A in a piece of B. `work`: evaluations, added to.
double lower_bound_by_pieces_mm(const PiecesQuery& query, std::uint64_t& work);

}  // namespace mortise::gpd
