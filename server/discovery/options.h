#pragma once
#include "server/discovery/discovery_server.h"

namespace mortise {

struct DiscoveryCommand {
  DiscoveryOptions where;
  double duration_s = 0.0;  ///< 0: until a signal
  bool json = false, quiet = false;
  int exit_code = -1;  ///< not below 0: end with it, everything has been said
};

DiscoveryCommand read_discovery_command(int argc, char** argv);

}  // namespace mortise
