#pragma once
#include <array>

#include "common/ccd/pair_motion.h"
#include "common/geometry/bvh/bvh_support.h"

// How far apart the convex hulls of two meshes are, from their trees: where the hulls are apart,
// the plane between them proves at once what boxes around curved faces prove only piece by piece.
namespace mortise::ccd {

/// Leaves with a corner above floor_mm along n (unit, axes of the part, from the origin of the
/// tree).
struct LeafHeight {
  std::int32_t leaf;
  double along_mm;  ///< of its farthest corner
};
inline constexpr int kMostLeaves = 512;  ///< 8 KiB on the stack; more are left to the trees
struct LeafList {
  std::array<LeafHeight, kMostLeaves> leaf;
  int count = 0;
};
/// False when there are more than `most`; the list is then useless.
bool leaves_above(const Bvh& bvh, const Vec3& n, double floor_mm, LeafList& list,
                  int most = kMostLeaves);

struct HullGap {
  bool apart = false;     ///< false: the hulls overlap, or nothing was proven
  double gap_mm = 0.0;    ///< every pair of points is farther apart along n, up to rounding
  Vec3 n = Vec3::Zero();  ///< unit, from A to B, axes of B
  double far_a_mm = 0.0;  ///< the farthest corner of A along n, from the origin of B's tree
  double near_b_mm = 0.0;
  int pairs = 0;  ///< leaves that hold the corners nearest to each other
  std::int32_t leaf_a[4], leaf_b[4];
};

/// At motion.state(); `v`: a first guess of the way from A to B, axes of B, mm. Gilbert, Johnson
/// and Keerthi 1988, on the corners that the trees find. most_steps 1: the plane across `v` and no
/// other.
HullGap hull_gap(const PairMotion& motion, const Bvh& a, const Bvh& b, const Vec3& v,
                 int most_steps = 32);

}  // namespace mortise::ccd
