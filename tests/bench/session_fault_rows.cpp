// Who is killed: how soon the others know, and how soon it goes on.
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

constexpr double kPresenceBar_leases = 1.1;
constexpr double kRestartBar_s = 1.0;

/// A participant of this process that looks on.
struct Watcher {
  explicit Watcher(int domain) {
    DdsOptions options;
    options.domain = domain;
    lease_s = options.liveliness_lease_s;
    auto opened = open_client_channel(options);
    if (!opened) return;
    channel = std::move(*opened);
    client = std::make_unique<Client>(*channel);
    client->add_user("watcher", "observer");
  }
  bool is_in() const { return client->synced() && client->join_state(0) == JoinState::kJoined; }
  bool until(double limit_s, const std::function<bool()>& done) {
    if (!client) return false;
    for (const double end_s = steady_s() + limit_s; steady_s() < end_s; sleep_s(0.001)) {
      client->poll();
      if (done()) return true;
    }
    return false;
  }
  bool holds_something(const std::string& name) const {
    for (const UserInfo& user : client->users())
      for (const auto& [id, part] : client->parts())
        if (user.name == name && user.present && part.info.holder == user.user) return true;
    return false;
  }

  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  double lease_s = 0.0;
};

/// Leases from the kill of one of three participants until another one knows; < 0: it did not.
double noticed_leases(int seed) {
  BenchServer server;
  Watcher watcher(server.domain());
  auto other = server.bots({"--behaviour", "shake", "--seconds", "60", "--names", "other"});
  auto victim = server.bots(
      {"--behaviour", "shake", "--seconds", "60", "--names", "victim", "--first-part", "3"});
  if (!watcher.until(20.0, [&] {
        return watcher.is_in() && watcher.holds_something("victim") &&
               watcher.holds_something("other");
      }))
    return -1.0;
  // Not always at the same place of its beat.
  watcher.until(0.3 + 0.037 * seed, [] { return false; });
  victim->signal(SIGKILL);
  const double killed_s = steady_s();
  if (!watcher.until(5.0, [&] { return !watcher.holds_something("victim"); })) return -1.0;
  return (steady_s() - killed_s) / watcher.lease_s;
}

/// Seconds from the new process's start until a participant is in it with a whole scene, after a
/// session of so many seconds; < 0: it did not come.
double restart_gap_s(double session_s, bool from_log) {
  BenchServer server;
  Watcher watcher(server.domain());
  auto bots = server.bots(
      {"--users", "8", "--rate", "60", "--behaviour", "mixed", "--seconds", "600", "--seed", "3"});
  if (!watcher.until(20.0, [&] { return watcher.is_in(); })) return -1.0;
  watcher.until(session_s, [] { return false; });
  const double started_s = server.restart(from_log);
  const bool back = watcher.until(120.0, [&] {
    return watcher.client->statistics().server_losses > 0 && watcher.is_in() &&
           watcher.client->server_present();
  });
  const double gap_s = steady_s() - started_s;
  bots->signal(SIGTERM);
  bots->wait(10.0);
  return back ? gap_s : -1.0;
}

}  // namespace

void section_presence(Report& report, const SessionOptions& options) {
  report.table(
      "One of three participants is killed in the middle of a drag: leases until another one sees "
      "its part free",
      {"kills", "failed", "median", "largest", "load average"});
  std::vector<double> leases;
  long long failed = 0;
  const int kills = options.quick ? 4 : 20;
  for (int i = 0; i < kills; ++i) {
    const double one = noticed_leases(i);
    if (one < 0.0) {
      ++failed;
    } else {
      leases.push_back(one);
    }
  }
  report.row({static_cast<long long>(kills), failed, median(leases), largest(leases),
              fmt::format("{:.1f}", load_average())});
  report.bar("presence loss noticed, largest, leases", failed == 0 ? largest(leases) : std::nan(""),
             kPresenceBar_leases, BoundKind::kAtMost);
}

void section_restart(Report& report, const SessionOptions& options) {
  report.table(
      "The server is killed while eight users work on the demo scene: seconds from the new "
      "process's start until a participant is in again and knows the scene",
      {"session before", "begins with", "gap s", "load average"});
  const auto row = [&](double session_s, bool from_log) {
    const double gap_s = restart_gap_s(session_s, from_log);
    report.row({fmt::format("{:g} s", session_s),
                std::string(from_log ? "its log" : "the scenario"),
                gap_s < 0.0 ? std::nan("") : gap_s, fmt::format("{:.1f}", load_average())});
    return gap_s < 0.0 ? std::nan("") : gap_s;
  };
  report.bar("data gap after a restart from the scenario, s", row(5.0, false), kRestartBar_s,
             BoundKind::kAtMost);
  report.bar("data gap after a restart from the log of 5 s, s", row(5.0, true), kRestartBar_s,
             BoundKind::kAtMost);
  if (!options.quick)
    report.bar("data gap after a restart from the log of 30 s, s", row(30.0, true), kRestartBar_s,
               BoundKind::kAtMost);
}

}  // namespace mortise::bench
