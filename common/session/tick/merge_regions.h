#pragma once
#include <vector>

#include "common/depth/depth.h"

namespace mortise {

/// A shaft of 32 facets crosses its bore of 32 facets in up to 32 regions, but a designer sees one
/// collision of a shaft with a bore. Regions that the same two faces decide become one, which keeps
/// the place of its worst member, the largest of every bound (sup over a union), and the sum of the
/// areas. Faces are the same when both are declared, or when one is declared round and the places
/// are not farther apart than a circle of it is wide. The order stays deepest first.
std::vector<OverlapRegion> merge_regions(const std::vector<OverlapRegion>& regions,
                                         const SurfaceBand& band_a, const SurfaceBand& band_b);

}  // namespace mortise
