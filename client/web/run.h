#pragma once
#include "client/web/options.h"

namespace mortise::web {

/// Serves until SIGINT or SIGTERM. Returns the exit code.
int run_web(const WebOptions& options);

}  // namespace mortise::web
