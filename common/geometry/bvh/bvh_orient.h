#pragma once
#include "common/geometry/bvh/bvh.h"

namespace mortise::bvh {

/// Fills Bvh::oriented from the finished tree. Deterministic at any number of threads.
/// O(n) for the nodes that get their own axes.
void orient(Bvh& bvh, int threads);

}  // namespace mortise::bvh
