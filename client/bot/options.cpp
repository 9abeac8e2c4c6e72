#include "client/bot/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numbers>

#include "client/bot/behaviour.h"
#include "client/bot/load_report.h"
#include "common/base/result.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {
namespace {

std::string known_limits() {
  std::string text = "Names:";
  for (const auto& [name, meaning] : limit_names()) text += " " + name;
  return text;
}

Limit read_limit(const std::string& text) {
  const std::size_t sign = text.find('=');
  Limit limit{text.substr(0, sign), -1.0};
  const bool known = std::any_of(limit_names().begin(), limit_names().end(),
                                 [&](const auto& row) { return row.first == limit.name; });
  if (!known) throw CLI::ValidationError("--limit " + text + ": no such figure. " + known_limits());
  const bool read =
      sign != std::string::npos && CLI::detail::lexical_cast(text.substr(sign + 1), limit.bound);
  if (!read || !(limit.bound >= 0.0)) {
    throw CLI::ValidationError("--limit " + text + ": write NAME=VALUE, VALUE not below 0");
  }
  return limit;
}

void add_users(CLI::App& app, BotOptions& o) {
  app.add_option("--users", o.users, "So many users in this process")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--names", o.names, "Their names, comma separated")->delimiter(',');
  app.add_flag("--observer", o.observer, "Only look and count");
  app.add_option("--processes", o.processes, "So many processes, each with --users of its own")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--ramp", o.ramp_s, "Users come in evenly over so many seconds")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--seed", o.seed, "Seed of what is random")->capture_default_str();
}

void add_behaviour(CLI::App& app, BotOptions& o, double& tremor_deg) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add_option(name, value, text)->group("Behaviour");
  };
  add("--behaviour", o.behaviour, "What they do")
      ->check(CLI::IsMember(behaviour_names()))
      ->capture_default_str();
  add("--play", o.play, "Play file of --behaviour script (acts: user, part, steps)");
  add("--part", o.part, "Part to begin with (fight: the part that all want)");
  add("--first-part", o.first_part,
      "Number of the moving part that the first user begins with, from 0");
  add("--target", o.target, "guided: the part with the bore; default: the nearest that fits");
  add("--tries", o.guided.tries, "guided: insertions tried by each user")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  add("--tremor", o.guided.tremor_mm, "guided: how far the hand trembles, mm, each way")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  add("--tremor-deg", tremor_deg, "guided: how far it turns, degrees, each way")
      ->check(CLI::Range(0.0, 45.0))
      ->capture_default_str();
  app.add_flag("--free-hand", o.guided.free_hand, "guided: without a constraint, by eye")
      ->group("Behaviour");
  add("--rate", o.rate_hz, "Increments a second and user")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
}

void add_times(CLI::App& app, BotOptions& o) {
  app.add_option("--duration,--seconds", o.duration_s,
                 "Act for so many seconds; 0: until the script ends")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--wait", o.wait_s, "Wait so long for the server")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--delay", o.delay_s, "Wait so long between joining and the first act")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--linger", o.linger_s, "Listen on for so long after the last act")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void add_report(CLI::App& app, BotOptions& o, std::vector<std::string>& limits) {
  app.add_flag("--json", o.json, "Report as one JSON document");
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.add_option(
         "--limit", limits,
         "NAME=VALUE, again for more: exit with 5 when the figure is above. " + known_limits())
      ->group(kLimitsGroup);
  app.add_option_function<double>(
         "--max-p99-ms",
         [&](double ms) {
           o.limits.push_back({"p99_ms", ms});
         },
         "The same as --limit p99_ms=VALUE")
      ->group(kLimitsGroup)
      ->check(CLI::PositiveNumber);
  app.add_option("--junit", o.junit, "Write the limits to this file as a JUnit document")
      ->group(kLimitsGroup);
}

/// What options ask of each other.
void check_together(const BotOptions& o) {
  if (o.processes > 1 && (!o.names.empty() || o.behaviour == "script"))
    throw CLI::ValidationError("--processes makes up its users: without --names and script");
  if (o.behaviour == "script" && o.play.empty() && !o.observer)
    throw CLI::ValidationError("--behaviour script needs --play FILE");
}

}  // namespace

BotCommandLine read_bot_command_line(int argc, char** argv) {
  BotCommandLine line;
  BotOptions& o = line.options;
  CLI::App app{"mortise-bot: designers without hands, for load, tests and demos"};
  app.set_version_flag("--version", version_line("mortise-bot"));
  double tremor_deg = o.guided.tremor_rad * 180.0 / std::numbers::pi;
  std::vector<std::string> limits;
  add_client_network_options(app, o.network);
  add_users(app, o);
  add_behaviour(app, o, tremor_deg);
  add_times(app, o);
  add_report(app, o, limits);
  app.footer(
      "Exit codes: 0 ok, 1 no server or refused, 2 usage, 3 bad play file, 5 a figure is "
      "above its limit.");
  try {
    app.parse(argc, argv);
    o.guided.tremor_rad = tremor_deg * std::numbers::pi / 180.0;
    for (const std::string& text : limits) o.limits.push_back(read_limit(text));
    check_together(o);
    o.network.meshes = false;  // a bot does not look at parts
    o.network.features = o.behaviour == "guided" && !o.observer;
  } catch (const CLI::ParseError& error) {
    line.exit_code = exit_of_usage(app, error);
  }
  return line;
}

}  // namespace mortise
