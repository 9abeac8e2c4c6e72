#include "server/discovery/options.h"

#include <CLI/CLI.hpp>

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {

DiscoveryCommand read_discovery_command(int argc, char** argv) {
  DiscoveryCommand command;
  CLI::App app("mortise-discovery: where servers and clients of a site's sessions find each other");
  app.set_version_flag("--version", version_line("mortise-discovery"));
  app.add_option("--interface", command.where.interface, "IPv4 address of the own interface")
      ->group(kNetworkGroup)
      ->capture_default_str();
  app.add_option("--discovery-port", command.where.port, "UDP port to hear at; 0: 7398")
      ->group(kNetworkGroup)
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--duration", command.duration_s, "End after so many seconds; 0: at a signal")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--json", command.json, "Closing counts as one JSON document instead of a table");
  app.add_flag("--quiet", command.quiet, "Print warnings and errors only");
  app.footer(
      "Whoever is to be found, or looks, is started with --discovery-server HOST[:PORT]: "
      "mortise-server, mortise-bot, mortise-web, mortise-directory, mortise-replay play. Several "
      "may run; name them all, comma between. It needs no keys: it introduces, and who may take "
      "part is settled between server and client. SIGINT and SIGTERM end it; sessions go on.\n"
      "Exit codes: 0 ok, 1 the port is in use, 2 usage, 3 an address that cannot be.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    command.exit_code = exit_of_usage(app, error);
  }
  return command;
}

}  // namespace mortise
