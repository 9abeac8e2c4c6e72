#pragma once
#include <algorithm>
#include <limits>

#include "common/depth/depth.h"
#include "common/evaluation/verdict.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {

/// Two parts of which the overlap is asked.
struct OverlapCase {
  SolidPtr a, b;
  SurfaceBand band_a = nominal_band(), band_b = nominal_band();
  Pose X_WA = Pose(), X_WB = Pose();
  Refinement refinement = Refinement::kFull;
};

inline constexpr double kAll = -std::numeric_limits<double>::infinity();

inline OverlapResult overlap_of(const OverlapCase& c, bool only_certain = false,
                                double ignore_below_mm = kAll) {
  OverlapQuery query;
  query.only_certain = only_certain;
  query.ignore_below_mm = ignore_below_mm;
  query.a = c.a.get();
  query.b = c.b.get();
  query.band_a = &c.band_a;
  query.band_b = &c.band_b;
  query.X_WA = c.X_WA;
  query.X_WB = c.X_WB;
  query.refinement = c.refinement;
  CcdScratch scratch;
  return find_overlap(query, scratch);
}

inline CollisionClass class_of(const OverlapRegion& region, bool no_inside = false) {
  return classify(
      {region.delta_mm, region.certain_mm, region.possible_mm, region.has_witness, no_inside});
}

inline CollisionClass worst_class(const OverlapResult& result) {
  CollisionClass worst = CollisionClass::kNone;
  for (const OverlapRegion& region : result.regions)
    worst = std::max(worst, class_of(region, result.no_inside));
  return worst;
}

}  // namespace mortise
