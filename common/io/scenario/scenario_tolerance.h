#pragma once
#include <optional>
#include <string>
#include <utility>

#include "common/io/scenario/scenario_yaml.h"
#include "common/session/world/scenario.h"

/// What a scenario file says of tolerances. Private to the reader.
namespace mortise {

/// "±0.05", {plus_minus: 0.05}, {profile: 0.1, unequal: 0.03}, {lower: -0.02, upper: 0.01}.
std::optional<Scenario::Tolerance> read_tolerance(YamlContext& context, const YAML::Node& node,
                                                  const std::string& what);

/// The same from the keys plus_minus, profile (with unequal), lower and upper of a mapping; none of
/// them present is an error.
std::optional<Scenario::Tolerance> tolerance_of(const YamlMap& map);

/// 0.1, or {zone: 0.1, at: mmc}; at: rfs, mmc or lmc.
std::optional<Position> read_position(YamlContext& context, const YAML::Node& node,
                                      const std::string& what);

/// The statements of a feature: iso (with nominal and width_to), tolerance, position.
void read_feature_statement(YamlContext& context, const YamlMap& map,
                            Scenario::FeatureSpec& feature);

/// The statement of a fit: code (with nominal), plus_minus, profile, lower. Returns the key that
/// was used; empty, with an error, when there is none.
std::string read_fit_statement(YamlContext& context, const YamlMap& map, Scenario::FitSpec& fit);

/// Splits "Ø20 H7/g6" into its nominal diameter (file unit, 0 when none) and "H7/g6".
std::pair<double, std::string> split_nominal(const std::string& code);

}  // namespace mortise
