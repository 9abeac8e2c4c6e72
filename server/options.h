#pragma once
#include <optional>
#include <string>

#include "common/base/result.h"
#include "idl/dds_channel.h"
#include "server/inbox.h"

namespace mortise {

struct ServerOptions {
  std::string scenario;
  DdsOptions network;
  std::string standby_of;  ///< session to follow, and to go on with when its server is gone
  std::string restore;     ///< log to go on from, or folder of logs; empty: begin anew
  std::string log;         ///< file or existing folder; empty: sessions/<session>-<UTC>.mcap
  std::string etcd;        ///< nodes of the site's etcd; empty: none
  bool no_log = false;
  double log_rotate_mb = 0.0;  ///< size at which the next file is begun; 0: never
  int threads = 1;
  double duration_s = 0.0;  ///< 0: until a signal
  std::string stats;        ///< file for the closing JSON document
  bool json = false, quiet = false, live = false;
  std::string addresses;  ///< file of the gateway for browsers; empty: none
  std::string policy;     ///< empty: the scenario's
  double rate_hz = 0.0;   ///< 0: the scenario's
  InboxLimits limits;
  std::string metrics_address = "127.0.0.1";
  std::optional<int> metrics_port;  ///< none: no metrics; 0: a free one
  std::string messages = "text";    ///< or json: a line is an object
};

/// Reads the command line and prints help or a usage error.
struct CommandLine {
  ServerOptions options;
  int exit_code = -1;  ///< -1: continue, else end with it
};
CommandLine read_command_line(int argc, char** argv);

}  // namespace mortise
