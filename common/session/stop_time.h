#pragma once
#include "common/session/tick_work.h"

namespace mortise {

/// Time of the pair's segment up to which it is proven not to be real; 1: for all of it. For pairs
/// of which a part has a band; `touch` is the first contact of the meshes.
double stop_time_with_bands(PairWork& pair, const FirstContact& touch, CcdScratch& ccd);

/// How far a pair that is real at the start of its segment may go: as long as it gets no deeper.
/// Looked at in quarters of the segment; between them it is not looked at.
double withdrawal_time(PairWork& pair, CcdScratch& ccd);

}  // namespace mortise
