#pragma once
#include <array>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// A ball about one connected piece of the border of an open mesh, reaching kCrackReach times as
/// far as the border: beyond it the winding number is known, within it nothing is (README, section
/// 4). Part frame.
struct Crack {
  Vec3 center_mm = Vec3::Zero();
  double reach_mm = 0.0;

  bool covers(const Vec3& x) const { return (x - center_mm).norm() <= reach_mm; }
};

/// What is missing of an open mesh: triangles that balance every edge of it, and where they lie.
struct Cracks {
  std::vector<Crack> all;
  std::vector<std::array<Vec3, 3>> lids;

  bool cover(const Vec3& x) const;
};

/// Ascending by the lowest point of the border. Empty for a balanced mesh. O(n log n).
Cracks find_cracks(const TriangleMesh& mesh);

/// Small enough beside a part of this radius that the rest of it has an inside.
bool small(const Cracks& cracks, double part_radius_mm);

}  // namespace mortise
