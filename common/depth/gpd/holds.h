#pragma once
#include <cstdint>
#include <span>

#include "common/ccd/ccd_scratch.h"
#include "common/depth/gpd/minimax.h"

namespace mortise::gpd {

struct HoldsQuery {
  const Solid* a = nullptr;  ///< moves
  const Solid* b = nullptr;
  Pose X_WA, X_WB;
  std::span<const Vec3> points_W;  ///< of surfaces that lie in the other part
  double limit_mm = 0.0;           ///< nothing is shown beyond: a motion of this length parts them
  std::size_t most_lines = 96;
};

/// A lower bound of the path that some point of A must take, whatever motion parts it from B
/// (README, section 7). A hold is a ball of A deep in a ball of B: their centres must come apart,
/// which is a linear condition on the motion but for terms of second order. Certified by the
/// multipliers of the program in which all holds meet. `work`: evaluations, added to.
double lower_bound_by_holds_mm(const HoldsQuery& query, CcdScratch& scratch, std::uint64_t& work);

}  // namespace mortise::gpd
