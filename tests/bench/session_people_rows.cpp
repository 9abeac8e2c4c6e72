// Who is there without doing much, who stopped reading, who comes late.
#include <fmt/format.h>

#include <csignal>
#include <memory>

#include "client/client.h"
#include "idl/dds_channel.h"
#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kIdleBar_percent = 3.0;
constexpr double kReaderBar = 0.999;
constexpr double kJoinBar_s = 0.6;

/// Ticks carried out in the time of a run, as a share of those due. Hands tremble where parts stand
/// apart: what the engine does must not hide what a reader does.
struct Held {
  bool ran = false;
  double share = 0.0;
  long long missed = 0;
};

Held ticks_held(double seconds, bool stop_one) {
  BenchServer server;
  auto bots = server.bots({"--users", "8", "--rate", "60", "--behaviour", "shake", "--seconds",
                           std::to_string(seconds), "--seed", "2"});
  auto reader = server.bots({"--observer", "--seconds", std::to_string(seconds)});
  sleep_s(0.3 * seconds);
  if (stop_one) reader->signal(SIGSTOP);
  bots->wait(seconds + 90.0);
  if (stop_one) reader->signal(SIGCONT);
  reader->wait(30.0);
  const Json closing = server.close();
  if (!closing.is_object()) return {};
  const double ticks = closing["statistics"]["ticks"].get<double>();
  const double missed = closing["missed_deadlines"].get<double>();
  return {true, ticks / (ticks + missed), static_cast<long long>(missed)};
}

/// Seconds from opening a channel until the scene is known and a user has joined; < 0: it did not.
double join_s(int domain, const std::string& name) {
  DdsOptions options;
  options.domain = domain;
  const double start_s = steady_s();
  auto channel = open_client_channel(options);
  if (!channel) return -1.0;
  Client client(**channel);
  const LocalUser user = client.add_user(name, "observer");
  while (steady_s() - start_s < 10.0) {
    client.poll();
    if (client.synced() && client.join_state(user) == JoinState::kJoined) {
      const double took_s = steady_s() - start_s;
      client.leave(user);
      return took_s;
    }
    sleep_s(0.002);
  }
  return -1.0;
}

}  // namespace

void section_idle(Report& report, const SessionOptions& options) {
  report.table("An idle session of sixty parts, one observer, 60 Hz",
               {"seconds", "CPU %", "of which nothing was asked of geometry", "load average"});
  BenchServer server("idle.yaml");
  auto observer = server.bots({"--observer", "--seconds", "600"});
  sleep_s(4.0);
  const double seconds = options.quick ? 5.0 : 20.0;
  const double cpu_s = server.cpu_s(), start_s = steady_s();
  sleep_s(seconds);
  const double percent = 100.0 * (server.cpu_s() - cpu_s) / (steady_s() - start_s);
  observer->signal(SIGTERM);
  observer->wait(10.0);
  const Json closing = server.close();
  const bool asked_nothing =
      closing.is_object() && closing["statistics"]["stages"]["queries"]["first_contact"] == 0;
  report.row({seconds, percent, std::string(asked_nothing ? "yes" : "NO"),
              fmt::format("{:.1f}", load_average())});
  report.bar("idle session: % of one core", percent, kIdleBar_percent, BoundKind::kAtMost);
}

void section_reader(Report& report, const SessionOptions& options) {
  report.table("Ticks held, eight users on the demo scene and one reader beside them",
               {"reader", "seconds", "ticks held", "deadlines missed", "load average"});
  const double seconds = options.quick ? 8.0 : 30.0;
  const auto row = [&](const char* name, const Held& held) {
    report.row({std::string(name), seconds, held.ran ? held.share : std::nan(""), held.missed,
                fmt::format("{:.1f}", load_average())});
  };
  const Held without = ticks_held(seconds, false);
  row("reads", without);
  const Held with = ticks_held(seconds, true);
  row("stopped after a third of the time", with);
  report.bar("ticks held with one stopped reader / without",
             with.ran && without.ran ? with.share / without.share : std::nan(""), kReaderBar,
             BoundKind::kAtLeast);
}

void section_join(Report& report, const SessionOptions& options) {
  report.table(
      "Who comes late into the demo scene while eight users work: seconds until the scene "
      "is known and the user is in",
      {"joins", "failed", "median", "p99", "largest", "load average"});
  BenchServer server;
  auto bots = server.bots(
      {"--users", "8", "--rate", "60", "--behaviour", "mixed", "--seconds", "600", "--seed", "3"});
  sleep_s(4.0);
  std::vector<double> took_s;
  long long failed = 0;
  const int joins = options.quick ? 10 : 100;
  for (int i = 0; i < joins; ++i) {
    const double one_s = join_s(server.domain(), "late" + std::to_string(i));
    if (one_s < 0.0) {
      ++failed;
    } else {
      took_s.push_back(one_s);
    }
  }
  bots->signal(SIGTERM);
  bots->wait(10.0);
  report.row({static_cast<long long>(joins), failed, median(took_s), quantile(took_s, 0.99),
              largest(took_s), fmt::format("{:.1f}", load_average())});
  report.bar("late join, p99 s", failed == 0 ? quantile(took_s, 0.99) : std::nan(""), kJoinBar_s,
             BoundKind::kAtMost);
}

}  // namespace mortise::bench
