#pragma once
#include <string>

#include "client/web/gateway.h"
#include "idl/dds_channel.h"

namespace mortise::web {

struct WebOptions {
  DdsOptions network;
  std::string replay;     ///< show this session log instead; empty: a live session
  std::string read_log;   ///< of the live session, for reports; empty: there are none
  std::string page;       ///< folder
  std::string tokens;     ///< file; empty: made for this run
  std::string addresses;  ///< see AddressesTo
  GatewayOptions gateway;
  bool quiet = false;
};

struct WebCommandLine {
  WebOptions options;
  int exit_code = -1;  ///< -1: go on
};
WebCommandLine read_web_command_line(int argc, char** argv);

}  // namespace mortise::web
