#pragma once
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/math/interval.h"

namespace mortise {

/// One tolerance class of ISO 286-1:2010, e.g. "H7" at a nominal size.
struct SizeLimits {
  std::string code;
  bool hole = false;  ///< capital letter
  double nominal_mm = 0.0;
  Interval deviation_mm;  ///< [EI, ES] or [ei, es], of the diameter
};

/// Limits of a class at a nominal diameter (0 < D <= 500 mm), from the standard's tables, not from
/// its formulas. Grades 01, 0, 1 ... 18; letters a ... zc for shafts, A ... ZC for holes. Where the
/// standard has no value (t up to 24 mm, cd above 50 mm) the error says so and names neighbours.
Result<SizeLimits> iso286_limits(std::string_view code, double nominal_mm);

struct Fit {
  SizeLimits hole, shaft;
  Interval clearance_mm;  ///< diametral; negative is interference
};

/// "H7/g6" at a nominal diameter. An unknown letter, grade or size is an error that names the
/// nearest known ones.
Result<Fit> iso286_fit(std::string_view code, double nominal_mm);

}  // namespace mortise
