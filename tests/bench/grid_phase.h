#pragma once
#include <memory>

#include "common/broadphase/broad_phase.h"

namespace mortise::bench {

/// A grid of cells that parts enter and leave as they move (after Yang 2001), as a peer.
std::unique_ptr<BroadPhase> make_grid_phase(double cell_mm);

}  // namespace mortise::bench
