#pragma once
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "common/geometry/recognition/region.h"

/// Private to recognition: from regions to named features.
namespace mortise {

/// Joins regions of one surface that cover the same stretch of its axis, leaves out doubtful rows,
/// adds planes, orders and names.
Recognition finish_recognition(const Solid& solid, const Facets& facets, RegionGrower& grower,
                               std::vector<Region> regions, bool planes);

}  // namespace mortise
