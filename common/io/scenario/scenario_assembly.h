#pragma once
#include "common/io/scenario/scenario_yaml.h"
#include "common/session/world/scenario.h"

/// What a scenario file says of a STEP assembly. Private to the reader.
namespace mortise {

/// "arm.step", or {file:, general:, fixed:, bought:, statements: [{part:, face:, iso: ...}]}.
void read_assembly(YamlContext& context, const YAML::Node& node, Scenario& scenario);

}  // namespace mortise
