#pragma once
#include "client/tools/generate/options.h"

namespace mortise {

/// Does what was asked for; returns the exit code.
int run_generate(const GenerateOptions& options);

}  // namespace mortise
