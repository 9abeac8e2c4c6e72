#pragma once
#include <spdlog/formatter.h>

#include <memory>

namespace mortise {

/// One JSON object a line: {"time": ISO 8601 UTC with ms, "level", "program", "message"}. For
/// collectors of messages; no colours.
std::unique_ptr<spdlog::formatter> json_lines();

}  // namespace mortise
