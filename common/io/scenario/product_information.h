#pragma once
#include <vector>

#include "common/io/step/given_parts.h"
#include "common/session/world/scenario.h"

/// What a CAD file itself says of tolerances (PMI), as statements of a scenario.
namespace mortise {

/// Statements about the features of one part.
struct PartStatements {
  std::vector<Scenario::FeatureSpec> features;
};

/// By part of the document. Each statement of the file is listed as used, or as not used and why
/// (README, section on PMI).
std::vector<PartStatements> statements_of(const StepDocument& document,
                                          const std::vector<StepPartGiven>& given,
                                          std::vector<Scenario::AssemblySpec::Listed>& listed);

}  // namespace mortise
