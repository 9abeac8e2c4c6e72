#pragma once
#include <cstddef>
#include <string>

#include "common/base/result.h"
#include "common/session/tick/judge_world.h"
#include "common/session/world/world.h"

namespace mortise {

/// Moves a part to the end of the way out that a region of the report tells, and says so in a
/// sentence. number 0: of the worst region. An error when there is no such region, or it tells no
/// way.
Result<std::string> apply_way(World& world, const JudgeReport& report, std::size_t number);

}  // namespace mortise
