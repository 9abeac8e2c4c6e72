#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/feature.h"
#include "common/math/pose.h"
#include "common/session/world/world.h"

/// Which surfaces of two parts may be a hole and its shaft: for proposals, and for fits that name
/// parts only.
namespace mortise {

/// Is it more than half a turn of a cylinder? Less holds no shaft: a fillet, a groove.
bool is_round(const Surface& surface, double arc_rad);

/// Do a bore and a shaft have radii within 3 percent?
bool like_sizes(const Surface& bore, const Surface& shaft);

/// Do their axes agree as placed, within 1 degree and a tenth of the bore's radius?
bool axes_meet(const Surface& bore, const Pose& X_WBore, const Surface& shaft,
               const Pose& X_WShaft);

inline constexpr std::size_t kWholePart = static_cast<std::size_t>(-1);

inline bool has_wildcard(const std::string& text) { return text.find('*') != std::string::npos; }

/// One end of a fit: a feature by its index, or kWholePart.
struct FitEnd {
  const Part& part;
  std::size_t feature = kWholePart;
};

/// Of a feature that is none of kWholePart.
FitSide side_of(const FitEnd& end);

using FeatureIndices = std::pair<std::size_t, std::size_t>;  ///< of a and of b

/// The ends that a fit speaks of: those given, but where a code is said of whole parts, their holes
/// and shafts of like sizes: those whose axes meet as placed before all others, all of one nominal
/// size. An error when there are several sizes, or none. A fit with '*' for a part joins only those
/// whose axes meet, and nothing where there are none.
Result<std::vector<FeatureIndices>> fitting_features(const Scenario::FitSpec& fit, const FitEnd& a,
                                                     const FitEnd& b);

}  // namespace mortise
