#pragma once
#include "server/console.h"
#include "server/options.h"

namespace mortise {

/// Loads the scenario, opens log and channel, plays the session to its end, and prints the result.
/// Returns the exit code; every failure is one line on stderr. `console` may be null:
/// messages go elsewhere.
int serve(const ServerOptions& options, Console* console);

}  // namespace mortise
