// What DDS-Security costs: the same hands with and without keys, one after the other.
#include <fmt/format.h>

#include <algorithm>

#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"
#include "tests/network/key_ring.h"

namespace mortise::bench {
namespace {

constexpr double kLatencyBar = 2.5, kCpuBar = 1.5;
constexpr int kProcesses = 4, kUsers = 2;

struct Cost {
  bool ran = false;
  std::string why_not;
  double p50_ms = 0.0, p99_ms = 0.0, server_cpu = 0.0, clients_cpu = 0.0;  ///< of one core, %
};

/// Processor time of server and clients while all act, after all have joined.
Cost run(const test::KeyRing* keys, double tick_hz, double seconds) {
  const auto with_keys = [&](std::vector<std::string> words, const char* whose) {
    if (keys != nullptr) words.insert(words.end(), {"--keys", (*keys)[whose]});
    return words;
  };
  BenchServer server("gearbox.yaml", with_keys({"--rate", fmt::format("{}", tick_hz)}, "hall"));
  std::vector<std::unique_ptr<test::Program>> bots;
  for (int i = 0; i < kProcesses; ++i) {
    const std::string name = "mill";
    bots.push_back(server.bots(with_keys(
        {"--users", std::to_string(kUsers), "--names", fmt::format("{0}-{1}a,{0}-{1}b", name, i),
         "--rate", "60", "--behaviour", "shake", "--first-part", std::to_string(i * kUsers),
         "--seconds", fmt::format("{}", seconds + 4.0)},
        "mill")));
  }
  const auto clients_s = [&] {
    double sum = 0.0;
    for (const auto& bot : bots) sum += bot->running() ? bot->cpu_s() : std::nan("");
    return sum;
  };
  sleep_s(3.0);
  const double start_s = steady_s(), server_s = server.cpu_s(), bots_s = clients_s();
  sleep_s(seconds);
  Cost cost;
  const double percent = 100.0 / (steady_s() - start_s);
  cost.server_cpu = (server.cpu_s() - server_s) * percent;
  cost.clients_cpu = (clients_s() - bots_s) * percent;
  for (const auto& bot : bots) {
    const int code = bot->wait(60.0);
    const Json report = Json::parse(bot->out(), nullptr, false);
    if (code != 0 || !report.is_object()) {
      cost.why_not = bot->errors() + server.errors();
      return cost;
    }
    cost.p50_ms = std::max(cost.p50_ms, report["latency_ms"]["p50"].get<double>());
    cost.p99_ms = std::max(cost.p99_ms, report["latency_ms"]["p99"].get<double>());
  }
  cost.ran = server.close().is_object() && !std::isnan(cost.clients_cpu);
  return cost;
}

}  // namespace

void section_security(Report& report, const SessionOptions& options) {
  test::KeyRing keys("keys");
  keys.issue("hall", "server");
  keys.issue("mill", "bot");
  report.table("Eight users in four processes, 60 increments a second each, without and with keys",
               {"ticks Hz", "keys", "to pose p50 ms", "to pose p99 ms", "server CPU %",
                "clients CPU %", "load average"});
  // At 60 Hz most of the latency is the wait for the tick; at 500 Hz it is the way.
  for (const double tick_hz : {60.0, 500.0}) {
    std::vector<double> p99, cpu;
    for (int round = 0; round < (options.quick ? 1 : 5); ++round) {
      Cost cost[2];
      for (const bool secure : {false, true}) {
        Cost& c = cost[secure] = run(secure ? &keys : nullptr, tick_hz, options.quick ? 4.0 : 10.0);
        if (!c.ran) {
          report.note("did not run: " + c.why_not);
          continue;
        }
        report.row({tick_hz, std::string(secure ? "yes" : "no"), c.p50_ms, c.p99_ms, c.server_cpu,
                    c.clients_cpu, fmt::format("{:.1f}", load_average())});
      }
      if (!cost[0].ran || !cost[1].ran) continue;
      p99.push_back(cost[1].p99_ms / cost[0].p99_ms);
      cpu.push_back((cost[1].server_cpu + cost[1].clients_cpu) /
                    (cost[0].server_cpu + cost[0].clients_cpu));
    }
    report.bar(
        fmt::format("keys at {:g} Hz: latency p99, with / without, median of rounds", tick_hz),
        median(p99), kLatencyBar, BoundKind::kAtMost);
    report.bar(
        fmt::format("keys at {:g} Hz: CPU of all, with / without, median of rounds", tick_hz),
        median(cpu), kCpuBar, BoundKind::kAtMost);
  }
}

}  // namespace mortise::bench
