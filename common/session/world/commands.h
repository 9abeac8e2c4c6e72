#pragma once
#include "common/session/world/world.h"

namespace mortise {

/// Checks and applies one request of a user. On success `decision` is what to log. A refused
/// request changes nothing, and the reply gives the reason in a sentence.
Reply apply_command(World& world, const Command& command, Decision& decision);

}  // namespace mortise
