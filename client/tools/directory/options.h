#pragma once
#include <string>
#include <vector>

#include "idl/directory.h"

namespace mortise {

/// What mortise-directory was asked.
struct DirectoryCommand {
  std::vector<DdsOptions> places;  ///< one for each domain and port, all of the same hosts
  double wait_s = 3.0;
  bool json = false;
  int exit_code = -1;  ///< not below 0: end with it, everything has been said
};

DirectoryCommand read_directory_command(int argc, char** argv);

/// "3" or "5-8" or both with commas between, each once, rising; throws UsageError, which
/// says what is wrong, for anything else and for numbers outside of lo..hi.
std::vector<int> read_numbers(const std::string& text, int lo, int hi);

}  // namespace mortise
