#pragma once
#include <string>

#include "client/tools/judge/options.h"
#include "common/io/report_json.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"

namespace mortise {

struct JudgeTextStyle {
  bool color = false;
  bool verbose = false;  ///< places below each clash: depth, way out, and the explaining sentence
};

/// Clashes for people, worst first: one line a pair, led by its worst region. Then excluded pairs
/// that are near, and what was counted.
std::string judge_text(const OpenedScene& opened, const JudgeReport& report, JudgeTextStyle style);

/// The same as one document.
Json judge_json(const OpenedScene& opened, const JudgeReport& report);

/// What the options ask for, on a terminal in colour. `moved`: the sentence of a motion that led
/// here.
std::string judged(const OpenedScene& opened, const JudgeReport& report,
                   const JudgeOptions& options, const std::string& moved = "");

/// Is there a region of this class or a worse one?
bool finds(const JudgeReport& report, CollisionClass at_least);

}  // namespace mortise
