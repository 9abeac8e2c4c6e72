#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/math/types.h"

namespace mortise {

struct BotOptions {
  std::string session = "default";
  int domain = 0;
  std::string interface = "127.0.0.1";
  std::string server;  ///< empty: on the same machine
  int port = 0;
  std::vector<std::string> names;
  int users = 1;
  std::string behaviour = "wander";
  std::string play;  ///< file for the behaviour script
  std::string part;  ///< the part to begin with; for fight the one that all want
  std::uint64_t seed = 1;
  double rate_hz = 60.0;
  double duration_s = 0.0;  ///< 0: until the script ends or a signal comes
  double wait_s = 5.0;      ///< for the server
  double delay_s = 0.0;     ///< between having joined and the first act
  double linger_s = 0.5;    ///< listening on after the last act
  bool observer = false, json = false, quiet = false;
  double max_p99_ms = 0.0;  ///< 0: no limit
};

struct BotCommandLine {
  BotOptions options;
  int exit_code = -1;  ///< -1: go on
};
BotCommandLine read_bot_command_line(int argc, char** argv);

}  // namespace mortise
