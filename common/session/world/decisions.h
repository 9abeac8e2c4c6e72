#pragma once
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// Applies a decision without checking rights: join, leave (frees the user's parts), lease end, and
/// in a replay all others. A join without a user id takes the next one, which is then
/// users.back().id. With the id of an absent user it brings that user back, or, where
/// takes_over_id(), gives the id to another user, who inherits nothing. Returns the parts whose
/// holder or pose changed, by id. A decision that cannot apply (unknown user or part) changes
/// nothing.
std::vector<PartPose> apply_decision(World& world, const Decision& decision);

}  // namespace mortise
