#pragma once
#include <optional>

#include "common/depth/generalized_depth.h"

// What a separating motion meets before its end.
namespace mortise {

/// Does the pair get deeper on the way than it is at its start, by more than the accuracy of the
/// query, or does it meet again after it came free? The overlap is looked at where the parts stand
/// in some places of the way, from the start to the last contact: `false` is no proof between them.
/// After the last contact the way is free by the guarantee of first contact. Cost: some ten
/// overlaps.
bool way_goes_deeper(const OverlapQuery& start, const SeparatingMotion& motion,
                     CcdScratch& scratch);

/// When the part meets another one on its way, as a share of it; none: never, by the guarantee of
/// first contact. What touches at the start and is not pressed is let go; what overlaps at the
/// start counts as met where its overlap at the end is deeper than at the start.
std::optional<double> met_on_way(const Solid& part, const Pose& X_WP,
                                 const SeparatingMotion& motion, const Solid& other,
                                 const Pose& X_WO, CcdScratch& scratch);

}  // namespace mortise
