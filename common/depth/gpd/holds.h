#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "common/ccd/ccd_scratch.h"
#include "common/depth/gpd/minimax.h"

namespace mortise::gpd {

struct HoldsQuery {
  const Solid* a = nullptr;  ///< moves
  const Solid* b = nullptr;
  Pose X_WA, X_WB;
  std::span<const Vec3> points_W;  ///< of surfaces that lie in the other part
  double known_mm = 0.0;           ///< no motion that parts them is shorter, as is known already
  double limit_mm = 0.0;           ///< nothing is shown beyond: a motion of this length parts them
  std::size_t most_lines = 96;
};

struct HeldBy {
  double least_mm = 0.0;      ///< no motion that parts them is shorter; known_mm at least
  std::optional<Vec6> twist;  ///< what all holds ask for, about TwistFrame(a, X_WA): may part them
};

/// A lower bound of the path that some point of A must take, whatever motion parts it from B
/// (README, section 7). A hold is a ball of A deep in a ball of B: their centres must come apart,
/// which is a linear condition on the motion but for terms of second order. Certified by the
/// multipliers of the program in which all holds meet. `work`: evaluations, added to.
HeldBy held_by_balls(const HoldsQuery& query, CcdScratch& scratch, std::uint64_t& work);

}  // namespace mortise::gpd
