#pragma once
#include <vector>

#include "common/depth/depth.h"

namespace mortise {

/// One place at which the certain overlap of two parts holds them apart.
struct HoldPlace {
  Vec3 point_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();  ///< unit; moving A along it separates
  double depth_mm = 0.0;          ///< of the least surfaces in each other; negative: apart
};

/// The places where a region holds the parts apart. The normal is that of the part that is smooth
/// there, of its true surface where one is known; where both are smooth, or both meet at an edge,
/// that of the region. A round edge of the other part, or a shaft in its bore, holds all around:
/// further places along it follow. Of a bracket wider than accuracy_mm the lower end is used.
std::vector<HoldPlace> hold_places(const OverlapQuery& query, const OverlapRegion& region,
                                   double accuracy_mm);

/// The same at a place that becomes certain a little later, where the parts are not near enough yet
/// for a region.
std::vector<HoldPlace> hold_places(const OverlapQuery& query, const CertainPlace& place,
                                   double accuracy_mm);

}  // namespace mortise
