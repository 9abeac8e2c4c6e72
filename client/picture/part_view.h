#pragma once
#include <string>
#include <vector>

#include "client/picture/canvas.h"
#include "common/geometry/surface_band.h"
#include "common/messages/verdict.h"

namespace mortise {

/// One clash as it touches a part; part frame, mm.
struct ContactMark {
  Vec3 point_P = Vec3::Zero();
  Vec3 out_P = Vec3::UnitZ();  ///< unit, away from the material of the part
  double overlap_mm = 0.0;
  double fake_below_mm = 0.0, real_above_mm = 0.0;
  CollisionClass collision_class = CollisionClass::kNone;
  std::string face;  ///< feature, may be empty
};

/// Where a part was touched, and how deep: the part shaded, from the side that shows the deepest
/// mark and from the opposite one; faces that are named by a mark coloured by their worst one on
/// the scale of its thresholds (client/picture/heat.h), each place marked with the letter of its
/// class, a disc as large as it is bad, and the deepest few with their overlap. The bytes of a PNG
/// of 2 x 300 by 300 units. Cost: O(n log n) in triangles.
Result<std::string> part_picture(const TriangleMesh& mesh, const SurfaceBand& band,
                                 const std::vector<ContactMark>& marks);

}  // namespace mortise
