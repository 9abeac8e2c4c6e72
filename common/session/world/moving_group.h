#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/motion/motion.h"
#include "common/session/world/world.h"

namespace mortise {

/// What moves as one: a part, or all parts of its group.
struct MovingGroup {
  std::vector<std::uint32_t> parts;  ///< indices, rising
  Vec3 reference_W = Vec3::Zero();   ///< of a part: centre of its bounding sphere; of a group: mean
                                     ///< of its parts' reference points
  double radius_mm = 0.0;            ///< all points of the group are this near to reference_W

  /// What a turn is weighed by against a shift: the radius, of a mere point a micrometre.
  double lever_mm() const { return std::max(radius_mm, 1e-3); }
};

/// The group that part `index` moves with, as it stands. O(1) for a part without a group, else
/// O(parts).
MovingGroup moving_group_of(const World& world, std::uint32_t index);

/// The path of a part at X_W0 whose group makes a displacement about center_W: the centre moves
/// straight, the group turns about it. Parts of one group that are given the same centre and
/// displacement have the same velocities to the last bit, so that nothing changes between them.
Motion rigid_motion(const Pose& X_W0, const Vec3& center_W, const Displacement& by);

/// The same displacement about another point.
Displacement about(const Displacement& by, const Vec3& from_W, const Vec3& to_W);

/// Constraints that hold the group to parts outside of it, as they stand.
std::vector<Relation> relations_of(const World& world, const MovingGroup& group);

/// A point that keeps to the constraints when it moves straight and the group turns about it: of
/// the first common axis or centre; without one the group's reference point.
Vec3 straight_point(const MovingGroup& group, const std::vector<Relation>& relations);

}  // namespace mortise
