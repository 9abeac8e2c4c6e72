#pragma once
#include "client/tools/inspect/inspect.h"

namespace mortise {

/// A bore and a shaft of two parts that may belong together.
struct ProposedFit {
  std::size_t bore_part = 0, bore = 0, shaft_part = 0, shaft = 0;  ///< indices
  double clearance_mm = 0.0;  ///< of diameters, as modelled; negative: interference
};

/// Bores and shafts of more than half a turn with radii within 3 percent; where poses are known,
/// only pairs whose axes agree within 1 degree and a tenth of the radius.
std::vector<ProposedFit> proposed_fits(const std::vector<InspectedPart>& parts);

/// A scenario of these parts that can be judged as it stands; features and fits, whose tolerances
/// are unknown, as comments.
std::string proposed_yaml(const std::vector<InspectedPart>& parts);

}  // namespace mortise
