#pragma once
#include "common/depth/overlap.h"
#include "common/depth/pair_frame.h"
#include "common/depth/region_report.h"

namespace mortise {

/// Identical parts in one place: no surface lies inside the other, and yet the parts are one.
OverlapRegion region_of(const PairFrame& pair, const SharedInside& shared);

/// Parts that lie deep in each other are deeper inside than at their surfaces. Tells that of their
/// deepest region, and a witness where it has none; layers_known: that of the meshes alone. With
/// kFull to the accuracy of the query, as far as the work goes; lazily to some thousandths. Adds to
/// `evaluations`.
void tell_inner_overlap(const PairFrame& pair, const OverlapQuery& query, bool layers_known,
                        OverlapRegion& region, std::uint64_t& evaluations);

}  // namespace mortise
