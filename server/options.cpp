#include "server/options.h"

#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {
namespace {

void add_session(ProgramOptions& app, ServerOptions& o) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add(name, value, text).group(kSessionGroup);
  };
  app.add("scenario", o.scenario, "Scenario file (YAML)").reads_file();
  add("--restore", o.restore,
      "Continue from this session log, or from the newest one of the session in this folder (none "
      "there: "
      "begin SCENARIO)")
      .reads_file();
  must_name_a_session(
      add("--standby-of", o.standby_of,
          "Stand by for the server of this session, and take over when it is gone; --restore "
          "names its log, or the folder of it"));
  add("--etcd", o.etcd,
      "Nodes of the site's etcd (v3), IPv4:PORT, comma between: it says which of two servers "
      "leads; the same for both");
  add("--policy", o.policy, "Response to a real contact instead of the scenario's")
      .one_of({"stop", "slide", "report"});
  add("--rate", o.rate_hz, "Ticks a second instead of the scenario's").in_range(1.0, 1000.0);
  add("--threads", o.threads,
      "Threads of the engine; ticks get work for so many. The log says so: a replay decides alike "
      "on any number")
      .in_range(1, 256)
      .shows_default();
  add("--duration", o.duration_s, "End after so many seconds; 0: at a signal").not_negative();
}

void add_log(ProgramOptions& app, ServerOptions& o) {
  const auto log = app.add("--log", o.log,
                           "Session log (NAME.mcap), or a folder for it, which is made; default "
                           "sessions/<session>-<UTC time>.mcap")
                       .group(kLogGroup)
                       .writes_file();
  app.add("--log-rotate", o.log_rotate_mb,
          "Begin the next file of the log (name_p0002.mcap ...) when one has so many MB; 0: "
          "never. Old files are yours to keep or to delete")
      .group(kLogGroup)
      .not_negative();
  app.add_flag("--no-log", o.no_log, "Write no session log").group(kLogGroup).excludes(log);
}

void add_limits(ProgramOptions& app, InboxLimits& limits) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add(name, value, text).group(kLimitsGroup).shows_default();
  };
  add("--max-users", limits.max_users, "Users in the session at one time").in_range(1, 4096);
  add("--max-names", limits.names_kept, "Names that the session remembers, also of absent users")
      .in_range(1, 1000000);
  add("--max-messages", limits.messages_per_s, "Increments and commands a second and user")
      .in_range(1.0, 1e6);
  add("--max-session-messages", limits.session_messages_per_s, "The same for all users together")
      .in_range(1.0, 1e7);
  add("--max-parts", limits.parts_per_user, "Parts that one user may hold").in_range(1, 1000000);
}

void add_metrics(ProgramOptions& app, ServerOptions& o) {
  app.add("--metrics-port", o.metrics_port,
          "Serve /metrics (Prometheus text) and /healthz over HTTP; 0: a free port")
      .group(kMetricsGroup)
      .in_range(0, 65535);
  app.add("--metrics-address", o.metrics_address, "IPv4 address to serve them at")
      .group(kMetricsGroup)
      .shows_default();
}

void add_output(ProgramOptions& app, ServerOptions& o) {
  app.add("--stats", o.stats, "Write the closing statistics to this file (JSON)").writes_file();
  app.add_flag("--json", o.json, "Closing statistics as one JSON document instead of tables");
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.add_flag("--live", o.live, "Status line: time, users, open clashes, tick time");
  app.add("--addresses", o.addresses,
          "With --live on a terminal, what mortise-web writes to this file stays below the status "
          "line");
  app.add("--messages", o.messages, "Messages on stderr: text, or json, one object a line")
      .one_of({"text", "json"})
      .shows_default();
}

/// What options ask of each other.
void check_together(const ServerOptions& o) {
  if (o.scenario.empty() && o.restore.empty())
    throw UsageError("a SCENARIO to play, or --restore LOG");
  if (!o.standby_of.empty() && o.restore.empty())
    throw UsageError("--standby-of needs --restore: the log of the session, or its folder");
  if (o.network.keys.empty() && !o.network.interface.starts_with("127."))
    throw UsageError("--interface " + o.network.interface +
                     " opens the session to other hosts: give this server keys with "
                     "--keys FOLDER (made by mortise keys), or stay on 127.0.0.1");
  if (!o.restore.empty() && (!o.policy.empty() || o.rate_hz > 0.0))
    throw UsageError("--restore goes on as the log says: without --policy and --rate");
}

}  // namespace

CommandLine read_command_line(int argc, char** argv) {
  CommandLine line;
  ServerOptions& o = line.options;
  ProgramOptions app(
      "mortise-server: plays a scenario as a shared session and judges every collision",
      version_line("mortise-server"));
  add_session(app, o);
  add_server_network_options(app, o.network);
  std::string peers;
  app.add("--peers", peers,
          "Other hosts where a server of this session may run, comma between: IPv4, or a name of "
          "them")
      .group(kNetworkGroup);
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
  line.exit_code = app.read(argc, argv, [&] {
    check_together(o);
    if (!o.standby_of.empty()) o.network.session = o.standby_of;
    if (!peers.empty()) o.network.server = o.network.interface + "," + peers;
  });
  return line;
}

}  // namespace mortise
