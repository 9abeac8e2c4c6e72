#include "server/discovery/options.h"

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {

DiscoveryCommand read_discovery_command(int argc, char** argv) {
  DiscoveryCommand command;
  ProgramOptions app(
      "mortise-discovery: where servers and clients of a site's sessions find each other",
      version_line("mortise-discovery"));
  app.add("--interface", command.where.interface, "IPv4 address of the own interface")
      .group(kNetworkGroup)
      .shows_default();
  app.add("--discovery-port", command.where.port, "UDP port to hear at; 0: 7398")
      .group(kNetworkGroup)
      .in_range(0, 65535)
      .shows_default();
  app.add("--duration", command.duration_s, "End after so many seconds; 0: at a signal")
      .not_negative();
  app.add_flag("--json", command.json, "Closing counts as one JSON document instead of a table");
  app.add_flag("--quiet", command.quiet, "Print warnings and errors only");
  app.footer(
      "Whoever is to be found, or looks, is started with --discovery-server HOST[:PORT]: "
      "mortise-server, mortise-bot, mortise-web, mortise-directory, mortise-replay play. Several "
      "may run; name them all, comma between. It needs no keys: it introduces, and who may take "
      "part is settled between server and client. SIGINT and SIGTERM end it; sessions go on.\n"
      "Exit codes: 0 ok, 1 the port is in use, 2 usage, 3 an address that cannot be.");
  command.exit_code = app.read(argc, argv);
  return command;
}

}  // namespace mortise
