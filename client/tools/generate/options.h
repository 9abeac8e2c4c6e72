#pragma once
#include <map>
#include <optional>
#include <string>

namespace mortise {

struct GenerateOptions {
  bool list = false;
  std::string kind;
  std::map<std::string, double> parameters;
  std::string scene;  ///< scenario file: all its parts instead of one
  std::string out;
};

struct GenerateCommandLine {
  GenerateOptions options;
  std::optional<int> exit_code;  ///< set: end now (help was asked for, or the usage is wrong)
};

GenerateCommandLine read_generate_command_line(int argc, char** argv);

}  // namespace mortise
