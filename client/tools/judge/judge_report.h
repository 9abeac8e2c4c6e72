#pragma once
#include <string>

#include "common/io/report_json.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"

namespace mortise {

/// Verdicts of all pairs for people: for each region class, overlap and separation brackets,
/// thresholds and their sources, and the explaining sentence.
std::string judge_text(const OpenedScene& opened, const JudgeReport& report, bool color);

/// The same as one document.
Json judge_json(const OpenedScene& opened, const JudgeReport& report);

/// Is there a region of this class or a worse one?
bool finds(const JudgeReport& report, CollisionClass at_least);

}  // namespace mortise
