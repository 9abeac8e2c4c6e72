#pragma once
#include <optional>

#include "common/depth/answer/region_report.h"
#include "common/depth/depth.h"
#include "common/depth/pair_frame.h"

namespace mortise {

/// Identical parts in one place: no surface lies inside the other, and yet the parts are one.
OverlapRegion region_of(const PairFrame& pair, const SharedInside& shared);

/// Parts that lie in one place, duplicates or such that hold the middle of the other deep inside:
/// how deep at least, without a look at their surfaces. Lazily, and not where only what is certain
/// is asked. Adds to `evaluations`.
std::optional<OverlapRegion> find_in_one_place(const PairFrame& pair, const OverlapQuery& query,
                                               std::uint64_t& evaluations);

/// What is known before the inside is asked.
struct BeforeInside {
  bool layers = false;  ///< certain and possible: they change only where the overlap grows inside
  bool from_inside = false;  ///< the point of the region is inside both
  /// No point of two faces with a closed form is deeper, mm; deeper ones are of other faces. Below
  /// 0: there is no closed form.
  double closed_form_mm = -1.0;
};

/// Parts that lie deep in each other are deeper inside than at their surfaces. Tells that of their
/// deepest region, and a witness where it has none. With kFull to the accuracy of the query, as far
/// as the work goes; lazily to some thousandths. Adds to `evaluations`.
void tell_inner_overlap(const PairFrame& pair, const OverlapQuery& query,
                        const BeforeInside& before, OverlapRegion& region,
                        std::uint64_t& evaluations);

}  // namespace mortise
