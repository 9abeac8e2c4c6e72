#include "client/bot/options.h"

#include <algorithm>
#include <cstdlib>
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

// expect_clash A,B=CLASS
Limit read_expected(const std::string& text) {
  const std::size_t first = std::string(kExpectClash).size() + 1;
  const std::size_t comma = text.find(',', first), sign = text.rfind('=');
  Limit limit{kExpectClash, 0.0};
  if (comma != std::string::npos && sign != std::string::npos && comma < sign) {
    limit.part_a = text.substr(first, comma - first);
    limit.part_b = text.substr(comma + 1, sign - comma - 1);
    limit.expected = text.substr(sign + 1);
  }
  const bool is_class = limit.expected == "real" || limit.expected == "potential" ||
                        limit.expected == "fake" || limit.expected == "none";
  if (limit.part_a.empty() || limit.part_b.empty() || !is_class)
    throw UsageError("--limit " + text +
                     ": write 'expect_clash PART,PART=CLASS', CLASS real, potential, fake or none");
  return limit;
}

Limit read_limit(const std::string& text) {
  if (text.starts_with(std::string(kExpectClash) + " ")) return read_expected(text);
  const std::size_t sign = text.find('=');
  Limit limit{text.substr(0, sign), -1.0};
  const bool known = std::any_of(limit_names().begin(), limit_names().end(),
                                 [&](const auto& row) { return row.first == limit.name; });
  if (!known) throw UsageError("--limit " + text + ": no such figure. " + known_limits());
  const std::string bound = sign != std::string::npos ? text.substr(sign + 1) : "";
  char* end = nullptr;
  limit.bound = std::strtod(bound.c_str(), &end);
  if (bound.empty() || *end != '\0' || !(limit.bound >= 0.0))
    throw UsageError("--limit " + text + ": write NAME=VALUE, VALUE not below 0");
  return limit;
}

void add_users(ProgramOptions& app, BotOptions& o) {
  app.add("--users", o.users, "So many users in this process").in_range(1, 256).shows_default();
  app.add("--names", o.names, "Their names, comma separated").comma_separated();
  app.add_flag("--observer", o.observer, "Only look and count");
  app.add("--processes", o.processes, "So many processes, each with --users of its own")
      .in_range(1, 256)
      .shows_default();
  app.add("--ramp", o.ramp_s, "Users come in evenly over so many seconds").not_negative();
  app.add("--seed", o.seed, "Seed of what is random").shows_default();
}

void add_behaviour(ProgramOptions& app, BotOptions& o, double& tremor_deg) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return app.add(name, value, text).group("Behaviour");
  };
  add("--behaviour", o.behaviour, "What they do").one_of(behaviour_names()).shows_default();
  add("--play", o.play, "Play file of --behaviour script (acts: user, part, steps)").reads_file();
  add("--part", o.part, "Part to begin with (fight: the part that all want)");
  add("--first-part", o.first_part,
      "Number of the moving part that the first user begins with, from 0");
  add("--target", o.target, "guided: the part with the bore; default: the nearest that fits");
  add("--tries", o.guided.tries, "guided: insertions tried by each user")
      .in_range(1, 1'000'000)
      .shows_default();
  add("--tremor", o.guided.tremor_mm, "guided: how far the hand trembles, mm, each way")
      .in_range(0.0, 10.0)
      .shows_default();
  add("--tremor-deg", tremor_deg, "guided: how far it turns, degrees, each way")
      .in_range(0.0, 45.0)
      .shows_default();
  app.add_flag("--free-hand", o.guided.free_hand, "guided: without a constraint, by eye")
      .group("Behaviour");
  add("--rate", o.rate_hz, "Increments a second and user").in_range(1.0, 1000.0).shows_default();
}

void add_times(ProgramOptions& app, BotOptions& o) {
  app.add("--duration,--seconds", o.duration_s, "Act for so many seconds; 0: until the script ends")
      .not_negative();
  app.add("--wait", o.wait_s, "Wait so long for the server").not_negative().shows_default();
  app.add_flag("--for-people", o.for_people,
               "Wait with the first act until somebody has joined who is no bot");
  app.add("--delay", o.delay_s, "Wait so long between joining and the first act").not_negative();
  app.add("--linger", o.linger_s, "Listen on for so long after the last act")
      .not_negative()
      .shows_default();
}

void add_report(ProgramOptions& app, BotOptions& o, std::vector<std::string>& limits) {
  app.add_flag("--json", o.json, "Report as one JSON document");
  app.add_flag("--quiet", o.quiet, "Print warnings and errors only");
  app.add("--limit", limits,
          "NAME=VALUE, again for more: exit with 5 when the figure is above; or 'expect_clash "
          "PART,PART=CLASS', the worst told of them. " +
              known_limits())
      .group(kLimitsGroup);
  app.add_number(
         "--max-p99-ms",
         [&](double ms) {
           o.limits.push_back({"p99_ms", ms});
         },
         "The same as --limit p99_ms=VALUE")
      .group(kLimitsGroup)
      .positive();
  app.add("--junit", o.junit, "Write the limits to this file as a JUnit document")
      .group(kLimitsGroup)
      .writes_file();
}

/// What options ask of each other.
void check_together(const BotOptions& o) {
  if (o.processes > 1 && (!o.names.empty() || o.behaviour == "script"))
    throw UsageError("--processes makes up its users: without --names and script");
  if (o.behaviour == "script" && o.play.empty() && !o.observer)
    throw UsageError("--behaviour script needs --play FILE");
}

}  // namespace

BotCommandLine read_bot_command_line(int argc, char** argv) {
  BotCommandLine line;
  BotOptions& o = line.options;
  ProgramOptions app("mortise-bot: designers without hands, for load, tests and demos",
                     version_line("mortise-bot"));
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
  line.exit_code = app.read(argc, argv, [&] {
    o.guided.tremor_rad = tremor_deg * std::numbers::pi / 180.0;
    for (const std::string& text : limits) o.limits.push_back(read_limit(text));
    check_together(o);
    o.network.meshes = false;  // a bot does not look at parts
    o.network.features = o.behaviour == "guided" && !o.observer;
  });
  return line;
}

}  // namespace mortise
