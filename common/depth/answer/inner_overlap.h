#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "common/depth/pair_frame.h"
#include "common/math/interval.h"

namespace mortise {

/// The overlap over all points of both parts, not of their surfaces alone: the largest
/// depth_A(p) + depth_B(p) of a point p inside both, where depth is the distance from the mesh.
struct InnerOverlap {
  Interval depth_mm;  ///< lo is reached at point_W; hi is proven, for the meshes
  Vec3 point_W = Vec3::Zero();
  double in_either_mm = 0.0;  ///< the smaller of the two depths at point_W
  bool grows = true;          ///< false: no point is deeper than the start, lazily by a share
};

/// Where the search begins: points of the overlap, and how deep the deepest of them is, at least.
/// World frame, mm.
struct InnerStart {
  std::span<const Vec3> points_W;
  double depth_mm = 0.0;
  /// True: where the overlap does not grow away from those points, it is looked for all over the
  /// parts.
  bool everywhere = false;
  /// The bracket is to be no wider. Not everywhere: than some thousandths of the depth.
  double accuracy_mm = 0.0;
  /// The points are inside both parts, no points of a surface: the deepest of them is found, too.
  bool inside = false;
  /// The overlap is hardly deeper than this: little is spent where nothing is found that is.
  double expected_mm = -1.0;
};

/// None where no point is found at which the overlap is larger than at the start, and it is not
/// proven that there is none (README, section 1). Both parts need an inside. work_cap:
/// evaluations, where the bracket stays wide; each is one nearest point. Adds to `evaluations`.
std::optional<InnerOverlap> find_inner_overlap(const PairFrame& pair, const InnerStart& start,
                                               std::uint64_t work_cap, std::uint64_t& evaluations);

/// The slow twin: every point of a lattice of that step. A lower bound.
double inner_overlap_brute_force(const PairFrame& pair, double step_mm);

}  // namespace mortise
