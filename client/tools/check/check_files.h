#pragma once
#include "client/tools/check/check.h"
#include "client/tools/check/check_command.h"

namespace mortise {

/// Writes the files that the command asks for: CSV, page, JUnit, database, BCF, scenario
/// of a session. The first that cannot be
/// written fails.
Status write_check_files(const OpenedScene& opened, const CheckReport& report,
                         const CheckCommand& command);

}  // namespace mortise
