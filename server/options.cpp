#include "server/options.h"

#include <CLI/CLI.hpp>

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {
namespace {

void add_session(CLI::App& app, ServerOptions& o) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add_option(name, value, text)->group(kSessionGroup);
  };
  app.add_option("scenario", o.scenario, "Scenario file (YAML)");
  add("--restore", o.restore,
      "Continue from this session log, or from the newest one of the session in this folder (none "
      "there: "
      "begin SCENARIO)");
  must_name_a_session(
      *add("--standby-of", o.standby_of,
           "Stand by for the server of this session, and take over when it is gone; --restore "
           "names its log, or the folder of it"));
  add("--policy", o.policy, "Response to a real contact instead of the scenario's")
      ->check(CLI::IsMember({"stop", "slide", "report"}));
  add("--rate", o.rate_hz, "Ticks a second instead of the scenario's")
      ->check(CLI::Range(1.0, 1000.0));
  add("--threads", o.threads, "Threads of the engine; the results are the same")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  add("--duration", o.duration_s, "End after so many seconds; 0: at a signal")
      ->check(CLI::NonNegativeNumber);
}

void add_log(CLI::App& app, ServerOptions& o) {
  auto* log = app.add_option("--log", o.log,
                             "Session log (NAME.mcap), or a folder for it, which is made; default "
                             "sessions/<session>-<UTC time>.mcap")
                  ->group(kLogGroup);
  app.add_option("--log-rotate", o.log_rotate_mb,
                 "Begin the next file of the log (name_p0002.mcap ...) when one has so many MB; 0: "
                 "never. Old files are yours to keep or to delete")
      ->group(kLogGroup)
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--no-log", o.no_log, "Write no session log")->group(kLogGroup)->excludes(log);
}

void add_limits(CLI::App& app, InboxLimits& limits) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add_option(name, value, text)->group(kLimitsGroup)->capture_default_str();
  };
  add("--max-users", limits.max_users, "Users in the session at one time")
      ->check(CLI::Range(1, 4096));
  add("--max-names", limits.names_kept, "Names that the session remembers, also of absent users")
      ->check(CLI::Range(1, 1000000));
  add("--max-messages", limits.messages_per_s, "Increments and commands a second and user")
      ->check(CLI::Range(1.0, 1e6));
  add("--max-session-messages", limits.session_messages_per_s, "The same for all users together")
      ->check(CLI::Range(1.0, 1e7));
  add("--max-parts", limits.parts_per_user, "Parts that one user may hold")
      ->check(CLI::Range(1, 1000000));
}

void add_metrics(CLI::App& app, ServerOptions& o) {
  app.add_option("--metrics-port", o.metrics_port,
                 "Serve /metrics (Prometheus text) and /healthz over HTTP; 0: a free port")
      ->group(kMetricsGroup)
      ->check(CLI::Range(0, 65535));
  app.add_option("--metrics-address", o.metrics_address, "IPv4 address to serve them at")
      ->group(kMetricsGroup)
      ->capture_default_str();
}

void add_output(CLI::App& app, ServerOptions& o) {
  app.add_option("--stats", o.stats, "Write the closing statistics to this file (JSON)");
  app.add_flag("--json", o.json, "Closing statistics as one JSON document instead of tables");
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.add_flag("--live", o.live, "Status line: ticks, users, open clashes, tick time");
  app.add_option("--messages", o.messages, "Messages on stderr: text, or json, one object a line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

/// What options ask of each other.
void check_together(const ServerOptions& o) {
  if (o.scenario.empty() && o.restore.empty())
    throw CLI::ValidationError("a SCENARIO to play, or --restore LOG");
  if (!o.standby_of.empty() && o.restore.empty())
    throw CLI::ValidationError(
        "--standby-of needs --restore: the log of the session, or its folder");
  if (o.network.keys.empty() && !o.network.interface.starts_with("127."))
    throw CLI::ValidationError("--interface " + o.network.interface +
                               " opens the session to other hosts: give this server keys with "
                               "--keys FOLDER (made by mortise keys), or stay on 127.0.0.1");
  if (!o.restore.empty() && (!o.policy.empty() || o.rate_hz > 0.0))
    throw CLI::ValidationError("--restore goes on as the log says: without --policy and --rate");
}

}  // namespace

CommandLine read_command_line(int argc, char** argv) {
  CommandLine line;
  ServerOptions& o = line.options;
  CLI::App app{"mortise-server: plays a scenario as a shared session and judges every collision"};
  app.set_version_flag("--version", version_line("mortise-server"));
  add_session(app, o);
  add_server_network_options(app, o.network);
  std::string peers;
  app.add_option(
         "--peers", peers,
         "Other hosts where a server of this session may run, comma between: IPv4, or a name of "
         "them")
      ->group(kNetworkGroup);
  add_log(app, o);
  add_limits(app, o.limits);
  add_metrics(app, o);
  add_output(app, o);
  app.footer(
      "Signals: SIGINT and SIGTERM end the session. SIGUSR1 drains the server: the one that stands "
      "by goes on with the session at once; where none stands by, the log gets a checkpoint of the "
      "last tick, from which --restore goes on elsewhere.\n"
      "Exit codes: 0 ok, 1 runtime error (port in use, log not writable), 2 usage, 3 bad scenario "
      "or log, 4 the log to restore from and this engine disagree.");
  try {
    app.parse(argc, argv);
    check_together(o);
    if (!o.standby_of.empty()) o.network.session = o.standby_of;
    if (!peers.empty()) o.network.server = o.network.interface + "," + peers;
  } catch (const CLI::ParseError& error) {
    line.exit_code = exit_of_usage(app, error);
  }
  return line;
}

}  // namespace mortise
