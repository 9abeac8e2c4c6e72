#pragma once
#include "common/depth/pair_frame.h"

/// What surfaces do not show of an overlap.
namespace mortise {

/// Regions that lie in a crack of a part are marked, since what was found there is a guess; where
/// the other part comes into a crack and `tell` is set, a region is added if none is marked. A few
/// questions a lid.
void mark_cracks(const PairFrame& pair, bool tell, OverlapResult& result);

/// Of a part that lies wholly in the other, in the first region: the sum of depths at the deepest
/// point inside that is found, which no point of a surface may reach, as lower end; the upper end
/// covers all others. Some hundred questions.
void look_inside(const PairFrame& pair, OverlapResult& result);

}  // namespace mortise
