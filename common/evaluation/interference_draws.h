#pragma once
#include <cstdint>

#include "common/math/interval.h"

namespace mortise {

/// Where the overlap of one region may lie, as interference_probability takes it. mm.
struct InterferenceZones {
  Interval certain_mm, possible_mm;         ///< overlap at the lower and at the upper offsets
  Interval tolerance_a_mm, tolerance_b_mm;  ///< outward offsets of both faces
};

struct InterferenceEstimate {
  std::uint64_t draws = 0;
  std::uint64_t interfering = 0;
  double probability() const {
    return static_cast<double>(interfering) / static_cast<double>(draws);
  }
  /// One standard deviation of probability() when the true value is p.
  double sampling_error(double p) const;
};

/// The slow twin of interference_probability: draws both offsets and the doubt about the mesh
/// (normal, +-3 sigma at the limits) and counts how often they interfere. The same seed and number
/// of draws give the same count. draws > 0; O(draws).
InterferenceEstimate draw_interference(const InterferenceZones& zones, std::uint64_t seed,
                                       std::uint64_t draws);

}  // namespace mortise
