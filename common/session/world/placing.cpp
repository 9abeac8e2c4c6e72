#include "common/session/world/placing.h"

#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"

namespace mortise {

void put(World& world, Part& part, const Pose& X_WP, const Decision& by) {
  part.X_WP = X_WP;
  rest_guides_of(world, part.id);
  note_placed(world, part.id.value - 1, by);
}

void give(World& world, Part& part, UserId holder) {
  part.holder = holder;
  part.asked_by = UserId{};
  part.group = {};
  part.history.end_move();
  drop_constraints_of(world, part.id);
  note_holder(world, part.id.value - 1);
}

PartPose pose_of(const Part& part) { return {part.id, part.holder, part.X_WP}; }

std::string quoted_name(const World& world, UserId id) {
  if (!id) return "a user who left long ago";
  const User* user = world.find(id);
  return user ? "'" + user->name + "'" : "user " + std::to_string(id.value);
}

}  // namespace mortise
