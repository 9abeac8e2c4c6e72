#pragma once
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/evaluation/tolerance.h"
#include "common/session/world/scenario.h"

/// Statements of a scenario with their lines, and how several about one face combine. Private to
/// scene_load.
namespace mortise {

/// A statement and its line (of two combined ones that of the tighter).
struct PlacedStatement {
  FaceStatement statement;
  SourceLine at;
};

/// The intersection of both; an error that names both lines when they exclude each other.
Result<PlacedStatement> both_hold(const PlacedStatement& a, const PlacedStatement& b);

/// The combined statement of a feature: its own (class, tolerance, position), that of a width whose
/// other plane it is, and that of the part. `all` are the features of the part.
Result<PlacedStatement> statement_of_feature(const Scenario::FeatureSpec& declared,
                                             std::span<const Scenario::FeatureSpec> all,
                                             double residual_mm, const PlacedStatement& part);

/// The statement for a band: positions added to sizes.
FaceStatement for_band(const PlacedStatement& placed);
std::vector<FaceStatement> for_band(const std::vector<PlacedStatement>& placed);

}  // namespace mortise
