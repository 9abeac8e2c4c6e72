#include "server/options.h"

#include <CLI/CLI.hpp>

namespace mortise {

CommandLine read_command_line(int argc, char** argv) {
  CommandLine line;
  ServerOptions& o = line.options;
  CLI::App app{"mortise-server: plays a scenario as a shared session and judges every collision"};
  app.add_option("scenario", o.scenario, "Scenario file (YAML)")->required();
  app.add_option("--session", o.session, "Name of the session that clients ask for")
      ->capture_default_str();
  app.add_option("--domain", o.domain, "DDS domain")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app.add_option("--interface", o.interface, "IPv4 address of the interface to be met on")
      ->capture_default_str();
  app.add_option("--port", o.port, "Discovery port; 0: the domain's own")
      ->check(CLI::Range(0, 65535));
  auto* log = app.add_option("--log", o.log,
                             "Session log (MCAP); default sessions/<session>-<UTC time>.mcap");
  app.add_flag("--no-log", o.no_log, "Write no session log")->excludes(log);
  app.add_option("--threads", o.threads, "Threads of the engine; the results are the same")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--duration", o.duration_s, "End after so many seconds; 0: at SIGINT or SIGTERM")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--stats", o.stats, "Write the closing statistics to this file (JSON)");
  app.add_flag("--json", o.json, "Closing statistics as one JSON document instead of tables");
  app.add_flag("--quiet", o.quiet, "Say warnings and errors only");
  app.add_flag("--live", o.live, "Status line: ticks, users, open clashes, tick time");
  app.add_option("--policy", o.policy, "Response to a real contact instead of the scenario's")
      ->check(CLI::IsMember({"stop", "report"}));
  app.add_option("--rate", o.rate_hz, "Ticks a second instead of the scenario's")
      ->check(CLI::Range(1.0, 1000.0));
  app.footer(
      "Exit codes: 0 ok, 1 runtime error (port in use, log not writable), 2 usage, 3 bad "
      "scenario.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    line.exit_code = app.exit(error) == 0 ? kExitOk : kExitUsage;
  }
  return line;
}

}  // namespace mortise
