#pragma once
#include <optional>

#include "common/io/scenario/scenario_yaml.h"
#include "common/session/world/scenario.h"

/// The parts of a scenario file: meshes, poses, features. Private to the reader.
namespace mortise {

/// Largest number of parts a scenario may have after instances and repeats.
inline constexpr std::size_t kMaxParts = 100'000;

/// Reads one entry of `parts` and appends it, once per instance or repeat.
void read_part(YamlContext& context, const YAML::Node& node, Scenario& scenario);

/// deviation: recognized | estimated | none, of the whole file or of one part.
std::optional<UndeclaredSurface> read_deviation(const YamlMap& map);

}  // namespace mortise
