// The demo, played again and again: whether its press fit is told each time, and nothing is left
// unexamined, however increments arrive.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/math/interval.h"
#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kPlay_s = 34.0, kPatience_s = 60.0;
// Servers that play at the same time: each is a further load for the others.
constexpr int kAtOnce = 5;
constexpr std::array<const char*, 2> kPressFit{"cover", "bearing_out_upper"};  // as it is told

/// Threads that compute and do nothing else.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int i = 0; i < count; ++i)
      threads_.emplace_back([](const std::stop_token& stop) {
        std::atomic<std::uint64_t> turns = 0;
        while (!stop.stop_requested()) ++turns;
      });
  }

 private:
  std::vector<std::jthread> threads_;
};

struct Play {
  bool ended_well = false, told = false;
  double not_examined = 0.0, tick_p99_ms = 0.0;
};

Play read_play(const Json& closing) {
  Play play;
  if (!closing.is_object()) return play;
  play.ended_well = true;
  const Json& statistics = closing["statistics"];
  for (const Json& pair : statistics["by_pair"]) {
    if (pair["part_a"] == kPressFit[0] && pair["part_b"] == kPressFit[1])
      play.told = pair["clashes"]["real"].get<int>() > 0;
  }
  play.not_examined = statistics["stages"]["not_examined"].get<double>();
  play.tick_p99_ms = 1e-3 * closing["times_us"]["tick"]["p99"].get<double>();
  return play;
}

std::vector<Play> play_at_once(int count) {
  struct Running {
    BenchServer server;
    std::unique_ptr<test::Program> bots;
  };
  std::vector<std::unique_ptr<Running>> running;
  const std::string script = std::string(MORTISE_SOURCE_DIR) + "/scenarios/gearbox.play.yaml";
  for (int i = 0; i < count; ++i) {
    running.push_back(std::make_unique<Running>());
    Running& r = *running.back();
    r.bots = r.server.bots(
        {"--behaviour", "script", "--play", script, "--duration", fmt::format("{}", kPlay_s)});
  }
  std::vector<Play> plays;
  for (const auto& r : running) {
    r->bots->wait(kPlay_s + kPatience_s);
    plays.push_back(read_play(r->server.close()));
  }
  return plays;
}

void play_rows(Report& report, int plays, int busy_loops) {
  const BusyLoops busy(busy_loops);
  int told = 0;
  std::vector<double> not_examined, tick_p99_ms;
  for (int left = plays; left > 0; left -= kAtOnce)
    for (const Play& play : play_at_once(std::min(left, kAtOnce))) {
      told += play.told ? 1 : 0;
      // A server that did not end in order has told nothing of what it left out.
      not_examined.push_back(play.ended_well ? play.not_examined : kInfinity);
      tick_p99_ms.push_back(play.tick_p99_ms);
    }
  report.row({static_cast<long long>(busy_loops), static_cast<long long>(plays),
              static_cast<long long>(told), largest(not_examined), largest(tick_p99_ms)});
  const std::string of = fmt::format("{} plays beside {} busy loops: ", plays, busy_loops);
  report.bar(of + "press fit told", told, plays, BoundKind::kAtLeast);
  report.bar(of + "not examined", largest(not_examined), 0.0, BoundKind::kAtMost);
}

}  // namespace

void section_plays(Report& report, const SessionOptions& options) {
  const int plays = options.quick ? 5 : 25;
  report.table(
      fmt::format("The demo, {} servers at a time; the press fit cover × bearing_out_upper",
                  kAtOnce),
      {"busy loops", "plays", "press fit told", "not examined, most of a play",
       "tick p99 ms, largest"});
  for (const int busy_loops : {0, 2}) play_rows(report, plays, busy_loops);
}

}  // namespace mortise::bench
