#pragma once
#include "common/depth/body.h"
#include "common/depth/overlap.h"

namespace mortise {

/// The search behind find_real_time and find_possible_time: first time at which the least (kLower)
/// or the largest (kUpper) surfaces interfere. "Real" reads "interferes in that layer".
RealTime first_interference(const SweptQuery& query, Layer layer);

}  // namespace mortise
