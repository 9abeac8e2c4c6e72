#pragma once
#include <cstdint>

#include "common/evaluation/interference.h"

namespace mortise {

struct InterferenceEstimate {
  std::uint64_t draws = 0;
  std::uint64_t interfering = 0;
  double probability() const {
    return static_cast<double>(interfering) / static_cast<double>(draws);
  }
  /// One standard deviation of probability() when the true value is p.
  double sampling_error(double p) const;
};

/// The slow twin of interference_probability: draws both sizes and both axes (normal, +-3 sigma at
/// the limits, each component of an axis by itself), moves the axes and counts how often the parts
/// interfere; the modelled overlap is the middle of its bracket. The same seed and number of draws
/// give the same count. draws > 0; O(draws).
InterferenceEstimate draw_interference(const InterferenceZones& zones, std::uint64_t seed,
                                       std::uint64_t draws);

}  // namespace mortise
