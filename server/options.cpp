#include "server/options.h"

#include <CLI/CLI.hpp>

#include "common/io/build_info.h"

namespace mortise {
namespace {

void add_operation(CLI::App& app, ServerOptions& o) {
  app.add_option("--max-users", o.limits.max_users, "Users in the session at one time")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--max-names", o.limits.names_kept,
                 "Names that the session remembers, also of absent users")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--max-messages", o.limits.messages_per_s,
                 "Increments and commands a second and user")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  app.add_option("--max-session-messages", o.limits.session_messages_per_s,
                 "The same for all users together")
      ->check(CLI::Range(1.0, 1e7))
      ->capture_default_str();
  app.add_option("--max-parts", o.limits.parts_per_user, "Parts that one user may hold")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--metrics-port", o.metrics_port,
                 "Serve /metrics (Prometheus text) and /healthz over HTTP; 0: a free port")
      ->check(CLI::Range(0, 65535));
  app.add_option("--metrics-address", o.metrics_address, "IPv4 address to serve them at")
      ->capture_default_str();
  app.add_option("--messages", o.messages, "Messages on stderr: text, or json, one object a line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

}  // namespace

CommandLine read_command_line(int argc, char** argv) {
  CommandLine line;
  ServerOptions& o = line.options;
  CLI::App app{"mortise-server: plays a scenario as a shared session and judges every collision"};
  app.set_version_flag("--version", version_line("mortise-server"));
  app.add_option("scenario", o.scenario, "Scenario file (YAML)");
  app.add_option(
      "--restore", o.restore,
      "Continue from this session log, or from the newest one of the session in this folder "
      "(none there: begin SCENARIO)");
  app.add_option("--standby-of", o.standby_of,
                 "Stand by for the server of this session, and take over when it is gone; "
                 "--restore names its log, or the folder of it");
  app.add_option(
      "--peers", o.peers,
      "Other hosts where a server of this session may run, comma between: IPv4, or a name of them");
  app.add_option("--discovery-server", o.discovery_server,
                 "Tell it where this server is: HOST[:PORT] of mortise-discovery, comma between. "
                 "Who asks there needs to know no host of the session, nor its --port");
  app.add_option("--session", o.session, "Name of the session that clients ask for")
      ->capture_default_str();
  app.add_option("--domain", o.domain, "DDS domain")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app.add_option("--interface", o.interface, "IPv4 address of the interface to listen on")
      ->capture_default_str();
  app.add_option("--port", o.port, "Discovery port; 0: the domain's own")
      ->check(CLI::Range(0, 65535));
  app.add_option(
      "--keys", o.keys,
      "Folder of this server's keys (mortise keys): only who has keys of the same site may "
      "come in, and all is encrypted; needed on any --interface but loopback");
  auto* log = app.add_option("--log", o.log,
                             "Session log (MCAP), or a folder for it; default "
                             "sessions/<session>-<UTC time>.mcap");
  app.add_option("--log-rotate", o.log_rotate_mb,
                 "Begin the next file of the log (name_p0002.mcap ...) when one has so many MB; 0: "
                 "never. Old files are yours to keep or to delete")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--no-log", o.no_log, "Write no session log")->excludes(log);
  app.add_option("--threads", o.threads, "Threads of the engine; the results are the same")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--duration", o.duration_s, "End after so many seconds; 0: at a signal")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--stats", o.stats, "Write the closing statistics to this file (JSON)");
  app.add_flag("--json", o.json, "Closing statistics as one JSON document instead of tables");
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.add_flag("--live", o.live, "Status line: ticks, users, open clashes, tick time");
  app.add_option("--policy", o.policy, "Response to a real contact instead of the scenario's")
      ->check(CLI::IsMember({"stop", "slide", "report"}));
  app.add_option("--rate", o.rate_hz, "Ticks a second instead of the scenario's")
      ->check(CLI::Range(1.0, 1000.0));
  add_operation(app, o);
  app.footer(
      "Signals: SIGINT and SIGTERM end the session. SIGUSR1 drains the server: the one that stands "
      "by "
      "goes on with the session at once; where none stands by, the log gets a checkpoint of the "
      "last "
      "tick, from which --restore goes on elsewhere.\n"
      "Exit codes: 0 ok, 1 runtime error (port in use, log not writable), 2 usage, 3 bad scenario "
      "or log, 4 the log to restore from and this engine disagree.");
  try {
    app.parse(argc, argv);
    if (o.scenario.empty() && o.restore.empty()) {
      throw CLI::ValidationError("a SCENARIO to play, or --restore LOG");
    }
    if (!o.standby_of.empty()) {
      o.session = o.standby_of;
      if (o.restore.empty()) {
        throw CLI::ValidationError(
            "--standby-of needs --restore: the log of the session, or its folder");
      }
    }
    if (o.keys.empty() && !o.interface.starts_with("127.")) {
      throw CLI::ValidationError("--interface " + o.interface +
                                 " opens the session to other hosts: give this server keys with "
                                 "--keys FOLDER (made by mortise keys), or stay on 127.0.0.1");
    }
    if (!o.restore.empty() && (!o.policy.empty() || o.rate_hz > 0.0)) {
      throw CLI::ValidationError("--restore goes on as the log says: without --policy and --rate");
    }
  } catch (const CLI::ParseError& error) {
    line.exit_code = app.exit(error) == 0 ? kExitOk : kExitUsage;
  }
  return line;
}

}  // namespace mortise
