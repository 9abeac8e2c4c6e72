#pragma once
#include <string>
#include <vector>

namespace mortise {

struct JudgeOptions {
  std::vector<std::string> files;  ///< one scenario, or meshes
  std::string unit, fit;           ///< of meshes; empty: mm, none
  std::string fail_on, picture;
  std::vector<std::size_t> regions;
  bool json = false, full = false, verbose = false, apply_way = false;
  int threads = 1;
};

/// Reads the command line and prints help or a usage error.
struct JudgeCommandLine {
  JudgeOptions options;
  int exit_code = -1;  ///< -1: continue, else end with it
};
JudgeCommandLine read_judge_command_line(int argc, char** argv);

}  // namespace mortise
