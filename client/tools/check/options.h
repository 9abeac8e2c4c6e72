#pragma once
#include "client/tools/check/check_command.h"

namespace mortise {

/// Reads the command line and prints help or a usage error.
struct CheckCommandLine {
  CheckCommand options;
  int exit_code = -1;  ///< -1: continue, else end with it
};
CheckCommandLine read_check_command_line(int argc, char** argv);

}  // namespace mortise
