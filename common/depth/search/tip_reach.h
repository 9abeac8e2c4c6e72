#pragma once
#include <cstdint>
#include <optional>

#include "common/depth/pair_frame.h"
#include "common/math/interval.h"

namespace mortise {

/// An edge or corner of the largest body of one part that the faces' own offsets do not account
/// for, and that may reach into the largest body of the other.
struct TipReach {
  int role = 0;                                    ///< whose tip: A for role 0, B for role 1
  std::uint32_t triangle = 0, other_triangle = 0;  ///< of the tip; of the other part, nearest
  Vec3 point_W = Vec3::Zero();
  Interval possible_mm;  ///< lo > 0: reached at the point; else it could not be excluded
  double gap_mm = 0.0;   ///< from the mesh of the other part, there
};

/// Where the faces of both parts, moved by their bands, keep apart: does a tip of either reach
/// farther? nullopt is proven (README, section 10), but for what PlaneFaces::kMostTravel cuts off.
/// Bounded work; where it ends the tip is told. Adds the pieces looked at to `evaluations`.
std::optional<TipReach> find_tip_reach(const PairFrame& pair, std::uint64_t& evaluations);

}  // namespace mortise
