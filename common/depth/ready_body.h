#pragma once
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"

namespace mortise {

/// Works out now, in this thread, what depth derives from a part with this band, so that the first
/// tick that judges it need not. Each of so many threads gets a copy of its own. Changes no answer.
/// O(triangles log triangles) a thread. Any thread.
void make_body_ready(const Solid& solid, const SurfaceBand& band, int threads);

}  // namespace mortise
