#pragma once
#include "common/session/world/world.h"

namespace mortise {

/// Builds what the first ticks would build of the parts and their surfaces, for so many threads
/// that judge, so that no tick waits for it. Takes about as long as loading the meshes did.
void make_world_ready(const World& world, int threads);

}  // namespace mortise
