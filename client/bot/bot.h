#pragma once
#include "client/bot/options.h"

namespace mortise {

/// Joins, acts, listens, and says what was seen. Returns the exit code.
int run_bot(const BotOptions& options);

}  // namespace mortise
