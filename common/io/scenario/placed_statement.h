#pragma once
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/evaluation/tolerance.h"
#include "common/session/world/scenario.h"

/// Statements of a scenario with the lines that say them, and how several of one face hold
/// together. Private to scene_load.
namespace mortise {

/// A statement and the line that says it (the tighter one's where two hold).
struct PlacedStatement {
  FaceStatement statement;
  SourceLine at;
};

/// What both leave together; an error that names both lines when they exclude each other.
Result<PlacedStatement> both_hold(const PlacedStatement& a, const PlacedStatement& b);

/// What holds of a feature: its own statement (class, tolerance, position) and that of a width it
/// is the other plane of, beside that of the part. `all` are the features of the part.
Result<PlacedStatement> statement_of_feature(const Scenario::FeatureSpec& declared,
                                             std::span<const Scenario::FeatureSpec> all,
                                             double residual_mm, const PlacedStatement& part);

/// What the bands are made of: positions added to sizes.
FaceStatement for_band(const PlacedStatement& placed);
std::vector<FaceStatement> for_band(const std::vector<PlacedStatement>& placed);

}  // namespace mortise
