#pragma once
#include <string>

#include "common/session/world/world.h"

namespace mortise {

/// Places a part at a pose without a motion.
void put(World& world, Part& part, const Pose& X_WP, const Decision& by);

/// Gives a part to a user, or frees it. This ends its last move and answers a pending request for
/// it.
void give(World& world, Part& part, UserId holder);

PartPose pose_of(const Part& part);

/// "'anna'", for sentences.
std::string quoted_name(const World& world, UserId user);

}  // namespace mortise
