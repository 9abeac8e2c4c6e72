#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/bot/behaviour.h"
#include "common/math/types.h"
#include "idl/dds_channel.h"

namespace mortise {

/// A figure of the report that must not be above `bound`, or a clash that is expected; names:
/// limit_names() of load_report.h.
struct Limit {
  std::string name;
  double bound = 0.0;
  /// Of expect_clash: two parts, and the worst class that is told of them. "none": nothing is.
  std::string part_a = {}, part_b = {}, expected = {};
};

struct BotOptions {
  DdsOptions network;
  std::vector<std::string> names;
  int users = 1;
  std::string behaviour = "wander";
  std::string play;            ///< file for the behaviour script
  std::string part;            ///< the part to begin with; for fight the one that all want
  std::string target;          ///< of guided: the part with the bore; empty: the nearest that fits
  GuidedSettings guided;       ///< tries, tremor, free hand
  std::size_t first_part = 0;  ///< the moving part that the first user begins with, by number
  std::uint64_t seed = 1;
  double rate_hz = 60.0;
  double duration_s = 0.0;  ///< 0: until the script ends or a signal comes
  double wait_s = 5.0;      ///< for the server
  bool for_people = false;  ///< the first act waits for somebody who is no bot
  double delay_s = 0.0;     ///< between having joined and the first act
  double linger_s = 0.5;    ///< listening on after the last act
  bool observer = false, json = false, quiet = false;
  int processes = 1;    ///< of so many users each
  double ramp_s = 0.0;  ///< users come in evenly over this time
  std::string junit;    ///< file for the limits as a JUnit document; empty: none
  std::vector<Limit> limits;
};

struct BotCommandLine {
  BotOptions options;
  int exit_code = -1;  ///< -1: go on
};
BotCommandLine read_bot_command_line(int argc, char** argv);

}  // namespace mortise
