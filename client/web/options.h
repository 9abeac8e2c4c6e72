#pragma once
#include <string>

#include "client/web/gateway.h"

namespace mortise::web {

struct WebOptions {
  std::string session = "default";
  int domain = 0;
  std::string interface = "127.0.0.1";
  std::string server;            ///< empty: on the same machine, or told by those:
  std::string discovery_server;  ///< HOST[:PORT] that know it, comma between; empty: none is asked
  int discovery_port = 0;
  std::string keys;         ///< folder; empty: no security
  std::string log;          ///< play this session log instead; empty: a live session
  std::string session_log;  ///< of the live session, for reports; empty: there are none
  std::string page;         ///< folder
  std::string tokens;       ///< file; empty: made for this run
  std::string addresses;    ///< see AddressesTo
  GatewayOptions gateway;
  bool quiet = false;
};

struct WebCommandLine {
  WebOptions options;
  int exit_code = -1;  ///< -1: go on
};
WebCommandLine read_web_command_line(int argc, char** argv);

}  // namespace mortise::web
