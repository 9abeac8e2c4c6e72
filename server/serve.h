#pragma once
#include "server/options.h"

namespace mortise {

/// Loads the scenario, opens log and channel, plays the session to its end, and says what came out.
/// Returns the exit code; every failure is one line on stderr.
int serve(const ServerOptions& options);

/// `yaml` with the top-level `key` set to `value`: its line replaced, or appended. So a log holds
/// the scenario as it was really played.
std::string with_top_level(const std::string& yaml, const std::string& key,
                           const std::string& value);

}  // namespace mortise
