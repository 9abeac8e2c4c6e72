#pragma once
#include "common/depth/pair_frame.h"

namespace mortise {

/// Regions that lie in a crack of a part are marked, since what was found there is a guess; where
/// the other part comes into a crack and `tell` is set, a region is added if none is marked. A few
/// questions a lid.
void mark_cracks(const PairFrame& pair, bool tell, OverlapResult& result);

}  // namespace mortise
