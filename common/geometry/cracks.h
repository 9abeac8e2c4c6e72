#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// One of the triangles that would close an open mesh. Part frame.
struct Lid {
  std::array<Vec3, 3> corners;
  std::size_t crack = 0;  ///< which connected piece of the border it closes part of
  /// So near the inside is not known: the width of the crack (README, section 4).
  double reach_mm = 0.0;
};

/// What is missing of an open mesh: lids that balance every edge of it, crack by crack.
struct Cracks {
  std::size_t count = 0;
  std::vector<Lid> lids;

  /// Is x so near a lid that its side is not known? O(lids).
  bool cover(const Vec3& x) const;
};

/// Ascending by the lowest point of the border. Empty for a balanced mesh. A crack is closed as
/// flat as it can be seen to be. O(n log n), and the square of the edges of a crack.
Cracks find_cracks(const TriangleMesh& mesh);

/// Small enough beside a part of this radius that the rest of it has an inside.
bool small(const Cracks& cracks, double part_radius_mm);

}  // namespace mortise
