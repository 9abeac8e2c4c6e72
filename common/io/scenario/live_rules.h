#pragma once
#include <memory>
#include <vector>

#include "common/io/scenario/scene_rules.h"
#include "common/session/world/surface_rules.h"

namespace mortise {

/// What a scenario says of tolerances, changeable while its session runs. Statements are read,
/// checked and combined by what reads and loads the file. Private to scene_load.
std::shared_ptr<SurfaceRules> make_live_rules(const Scenario& scenario,
                                              std::vector<StatedPart> stated);

}  // namespace mortise
