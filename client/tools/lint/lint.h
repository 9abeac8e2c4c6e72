#pragma once
#include <string>

#include "common/io/report_json.h"
#include "common/io/scenario/open_scene.h"

namespace mortise {

/// What lint says of a scenario, for people: findings, parts, resolved micrometres, fits.
std::string lint_text(const OpenedScene& opened, bool color);

/// The same as one document.
Json lint_json(const OpenedScene& opened);

}  // namespace mortise
