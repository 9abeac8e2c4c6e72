#pragma once
#include <optional>
#include <vector>

#include "common/depth/generalized_depth.h"

// What a separating motion meets before its end.
namespace mortise {

/// Do the meshes get deeper on the way than depth_mm, their overlap at the start, by more than the
/// accuracy of the query? The overlap is looked at in some places of the way, from the start to the
/// last contact, each with little work: `false` is no proof between them. After the last contact
/// the way is free by the guarantee of first contact. Cost: some ten short overlaps.
bool way_goes_deeper(const OverlapQuery& start, double depth_mm, const SeparatingMotion& motion,
                     CcdScratch& scratch);

/// When the part meets another one on its way, as a share of it; none: never, by the guarantee of
/// first contact. What touches at the start and is not pressed is let go; what overlaps at the
/// start counts as met where it gets deeper on the way.
std::optional<double> met_on_way(const Solid& part, const Pose& X_WP,
                                 const SeparatingMotion& motion, const Solid& other,
                                 const Pose& X_WO, CcdScratch& scratch);

/// Other motions that part the pair as well and are no longer than length_mm, the longest path of
/// `motion`, but for rounding: straight ones of that length along the main faces of both parts, and
/// `motion` with its shift, its turn or both reversed. Verified at their ends. Cost: some twenty
/// tests whether the meshes cross.
std::vector<SeparatingMotion> ways_as_long(const OverlapQuery& start,
                                           const SeparatingMotion& motion, double length_mm,
                                           CcdScratch& scratch);

}  // namespace mortise
