#pragma once
#include <string>
#include <vector>

#include "client/tools/check/check.h"

namespace mortise {

struct CheckCommand {
  std::vector<std::string> files;  ///< one assembly or scenario, or meshes
  std::string unit, fit;           ///< of meshes
  std::string fail_on, baseline;
  std::string csv, html, junit, sqlite, bcf;  ///< files to write; empty: none
  std::vector<std::string> bought;
  std::string general;
  bool json = false, verbose = false, propose = false;
  CheckOptions check;
};

/// Reads the command line and prints help or a usage error.
struct CheckCommandLine {
  CheckCommand options;
  int exit_code = -1;  ///< -1: continue, else end with it
};
CheckCommandLine read_check_command_line(int argc, char** argv);

}  // namespace mortise
