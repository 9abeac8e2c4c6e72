#pragma once
#include <string>

#include "common/io/progress_log.h"

namespace mortise {

/// One JSON object a line: {"time": ISO 8601 UTC with ms, "level", "program", "message"}. For
/// collectors of messages; no colours.
std::string json_line(const LogMessage& message);

}  // namespace mortise
