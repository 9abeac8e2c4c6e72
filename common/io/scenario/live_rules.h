#pragma once
#include <memory>
#include <vector>

#include "common/io/scenario/scene_rules.h"
#include "common/session/world/surface_rules.h"

namespace mortise {

/// The tolerances of a scenario, changeable while its session runs. The reader of the file also
/// reads, checks and combines the changes. Private to scene_load.
std::shared_ptr<SurfaceRules> make_live_rules(const Scenario& scenario,
                                              std::vector<StatedPart> stated);

}  // namespace mortise
