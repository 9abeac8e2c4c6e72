#pragma once
#include "common/ccd/ccd_scratch.h"
#include "common/depth/depth.h"
#include "common/session/world/world.h"

namespace mortise {

/// The separating motion that a verdict tells.
SeparatingMotion way_out(const Verdict& verdict);

/// Looks along it, past the pair and all other parts where they stand, and notes in the verdict
/// what it meets first. Where that is not free and another motion is as long and free, the verdict
/// tells that one. Nothing where there is no motion. For whoever looks at a verdict, not for every
/// tick: a first contact for each part near the way, and some ten overlaps of the pair.
/// depth_mm: of the pair at most.
void look_along_way(const World& world, PartId a, PartId b, double depth_mm, Verdict& verdict,
                    CcdScratch& scratch);

}  // namespace mortise
