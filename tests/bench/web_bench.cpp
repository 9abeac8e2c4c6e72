// Browsers beside a session: what they cost the server and its other participants, and the gateway
// itself. See README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <numeric>

#include "tests/bench/awake.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/statistics.h"
#include "tests/bench/web_load.h"

namespace mortise::bench {
namespace {

constexpr int kPages = 16;
constexpr char kScene[] = "stress.yaml";  // forty parts to move, above forty plates
constexpr double kSettled_s = 4.0;        // in each round as long, so that idle ticks are as many
constexpr double kTickRate_hz = 60.0;     // of the scene
// Of the bot that measures: its increments meet the tick at every phase, in each second once.
constexpr char kMeasuringRate[] = "61";
constexpr double kChangeBar = 1.05;
constexpr double kFramesBar = 0.98;
constexpr double kMemoryBar_mb_per_h = 1.0;
// Of a gateway with 16 pages. Chosen: twice what it had when the bar was set, and less than one of
// the browsers that it serves.
constexpr double kMemoryBar_mb = 64.0;

struct WebOptions : BenchOptions {
  int rounds() const { return quick ? 3 : 7; }
  double seconds() const { return quick ? 6.0 : 10.0; }
};

/// One round: what a bot and the server measured.
struct Round {
  bool ran = false;
  std::string why_not;
  double tick_p50_us = NAN, tick_p99_us = NAN, step_p50_us = NAN;
  double latency_p50_ms = NAN, latency_p90_ms = NAN;
  double frames_per_s = NAN, gateway_cpu_percent = NAN;
  double server_cpu_us = NAN, tick_cpu_us = NAN, tick_waited_us = NAN;  ///< a tick
};

enum class Beside {
  kNobody,
  kGatewayAlone,
  kPagesElsewhere,  ///< that look on at another session of the same machine
  kPagesThatLook,
  kBotsThatMove,
  kPagesThatMove
};

Round round_of(Beside beside, double seconds) {
  Round round;
  BenchServer server(kScene);
  std::unique_ptr<BenchServer> elsewhere;
  const double start_s = steady_s();
  // What lives beside the bot that measures is there before it, and after.
  std::unique_ptr<test::Program> movers;
  std::unique_ptr<BenchGateway> gateway;
  std::unique_ptr<PageLoad> pages;
  const auto one_bot = [&](BenchServer& of, double bot_s) {
    return of.bots({"--users", "1", "--behaviour", "shake", "--rate", kMeasuringRate, "--seed", "1",
                    "--seconds", std::to_string(bot_s)});
  };
  if (beside == Beside::kPagesElsewhere) {
    elsewhere = std::make_unique<BenchServer>(kScene);
    movers = one_bot(*elsewhere, seconds + 30.0);
  }
  if (beside == Beside::kBotsThatMove) {
    movers =
        server.bots({"--users", std::to_string(kPages), "--behaviour", "shake", "--first-part", "1",
                     "--rate", "60", "--seed", "2", "--seconds", std::to_string(seconds + 30.0)});
  } else if (beside != Beside::kNobody) {
    gateway = std::make_unique<BenchGateway>(elsewhere ? *elsewhere : server);
    PageLoad::Shape shape;
    shape.pages = beside == Beside::kGatewayAlone ? 0 : kPages;
    shape.moves = beside == Beside::kPagesThatMove;
    pages = std::make_unique<PageLoad>(*gateway, shape);
    if (!pages->joined()) {
      round.why_not = pages->why_not();
      return round;
    }
  }
  sleep_s(std::max(kSettled_s - (steady_s() - start_s), 0.0));
  auto bot = one_bot(server, seconds);
  if (pages) pages->mark();
  const double begin_s = steady_s(), cpu_s = gateway ? gateway->cpu_s() : 0.0;
  const double server_cpu_s = server.cpu_s();
  const ThreadTime ticking = first_thread_of(server.pid());
  const int exit_code = bot->wait(seconds + 60.0);
  const double took_s = steady_s() - begin_s;
  const double us_a_tick = 1e6 / (took_s * kTickRate_hz);
  const ThreadTime ticked = first_thread_of(server.pid());
  round.server_cpu_us = (server.cpu_s() - server_cpu_s) * us_a_tick;
  round.tick_cpu_us = (ticked.ran_s - ticking.ran_s) * us_a_tick;
  round.tick_waited_us = (ticked.waited_s - ticking.waited_s) * us_a_tick;
  if (pages) {
    round.gateway_cpu_percent = 100.0 * (gateway->cpu_s() - cpu_s) / took_s;
    pages->stop();
    double frames = 0.0;
    for (const auto& seen : pages->seen()) frames += static_cast<double>(seen.frames);
    round.frames_per_s = frames / kPages / took_s;
  }
  if (movers) {
    movers->signal(SIGTERM);
    movers->wait(10.0);
  }
  pages.reset();
  gateway.reset();
  if (elsewhere) elsewhere->close();
  const Json closing = server.close();
  const Json document = Json::parse(bot->out(), nullptr, false);
  if (exit_code != 0 || !closing.is_object() || !document.is_object()) {
    round.why_not = "bot: " + bot->errors() + "; server: " + server.errors();
    return round;
  }
  round.ran = true;
  round.tick_p50_us = closing["times_us"]["tick"]["p50"].get<double>();
  round.tick_p99_us = closing["times_us"]["tick"]["p99"].get<double>();
  round.step_p50_us = closing["times_us"]["step"]["p50"].get<double>();
  round.latency_p50_ms = document["latency_ms"]["p50"].get<double>();
  round.latency_p90_ms = document["latency_ms"]["p90"].get<double>();
  return round;
}

template <class Get>
double median_of(const std::vector<Round>& rounds, Get get) {
  std::vector<double> values;
  for (const Round& round : rounds) values.push_back(round.ran ? get(round) : NAN);
  return median(values);
}

struct Kind {
  const char* name;
  Beside beside;
  std::vector<Round> rounds = {};
};

template <class Get>
double change_of(const std::vector<Kind>& kinds, Get get) {
  return median_of(kinds.back().rounds, get) / median_of(kinds.front().rounds, get);
}

/// Rounds of all kinds in turn, so that what else the machine does strikes all. The last is held
/// against the first; what is between explains the difference.
std::vector<Kind> compare(Report& report, const WebOptions& options, const std::string& what,
                          std::vector<Kind> kinds) {
  report.table(what, {"beside a bot", "round", "tick p50 us", "tick p99 us", "its step p50 us",
                      "to pose p50 ms", "to pose p90 ms", "tick thread CPU us a tick",
                      "it waited for a core us a tick", "server CPU us a tick",
                      "frames a page and second", "gateway CPU %", "load average"});
  const Awake awake;
  for (int i = 0; i < options.rounds(); ++i) {
    for (Kind& kind : kinds) {
      const Round r = round_of(kind.beside, options.seconds());
      if (!r.ran) report.note("a round did not run: " + r.why_not);
      report.row({std::string(kind.name), static_cast<long long>(i + 1), r.tick_p50_us,
                  r.tick_p99_us, r.step_p50_us, r.latency_p50_ms, r.latency_p90_ms, r.tick_cpu_us,
                  r.tick_waited_us, r.server_cpu_us, r.frames_per_s, r.gateway_cpu_percent,
                  fmt::format("{:.1f}", load_average())});
      kind.rounds.push_back(r);
    }
  }
  const auto bar = [&](const char* figure, auto get) {
    report.bar(fmt::format("{}: {}, median of rounds with / without", what, figure),
               change_of(kinds, get), kChangeBar, BoundKind::kAtMost);
  };
  bar("tick p50", [](const Round& r) { return r.tick_p50_us; });
  bar("CPU of the tick thread", [](const Round& r) { return r.tick_cpu_us; });
  bar("to pose p50", [](const Round& r) { return r.latency_p50_ms; });
  return kinds;
}

void section_look(Report& report, const WebOptions& options) {
  const std::vector<Kind> kinds = compare(report, options, "16 pages that look on",
                                          {{"nobody", Beside::kNobody},
                                           {"a gateway without pages", Beside::kGatewayAlone},
                                           {"16 pages of another session", Beside::kPagesElsewhere},
                                           {"16 pages", Beside::kPagesThatLook}});
  // What the machine pays for programs beside the server, whoever's they are, and what the session
  // pays for its own pages. One bot shakes a part that is clear of all others.
  const auto beyond_strangers = [&](auto get) {
    return median_of(kinds.back().rounds, get) / median_of(kinds[2].rounds, get);
  };
  report.note(fmt::format(
      "Beside 16 pages of its own the tick's p50 is {:.2f} times and the CPU of its thread {:.2f} "
      "times what they are beside another session with 16 pages on the same machine.",
      beyond_strangers([](const Round& r) { return r.tick_p50_us; }),
      beyond_strangers([](const Round& r) { return r.tick_cpu_us; })));
  report.note(fmt::format(
      "The step of a tick computes the same in all three rows. Beside 16 pages its p50 is {:.2f} "
      "times as long as beside nobody, and all else that the tick does {:.2f} times as long.",
      change_of(kinds, [](const Round& r) { return r.step_p50_us; }),
      change_of(kinds, [](const Round& r) { return r.tick_p50_us - r.step_p50_us; })));
}

void section_move(Report& report, const WebOptions& options) {
  compare(report, options, "16 users at 60 Hz as pages instead of as bots",
          {{"16 bots", Beside::kBotsThatMove}, {"16 pages", Beside::kPagesThatMove}});
}

// Frames a page and second of 16 pages that move parts, with a stopped one beside them or without.
std::pair<double, double> frames_with(int stopped, double seconds, std::string& why_not) {
  BenchServer server(kScene);
  BenchGateway gateway(server);
  PageLoad::Shape shape;
  shape.pages = kPages;
  shape.moves = true;
  shape.first_part = 0;
  shape.stopped = stopped;
  PageLoad pages(gateway, shape);
  if (!pages.joined()) {
    why_not = pages.why_not();
    return {NAN, NAN};
  }
  sleep_s(2.0);
  pages.mark();
  const double start_s = steady_s();
  sleep_s(seconds);
  const double took_s = steady_s() - start_s;
  const Json statistics = gateway.statistics();
  pages.stop();
  double least = INFINITY;
  for (const auto& seen : pages.seen())
    least = std::min(least, seen.open ? static_cast<double>(seen.frames) / took_s : 0.0);
  return {least, statistics["incidents"]["stalled"].get<double>()};
}

void section_stopped(Report& report, const WebOptions& options) {
  report.table(
      "16 pages that move a part each, and one beside them that takes nothing",
      {"beside", "round", "frames a second, least of the 16", "closed as stalled", "load average"});
  std::vector<double> without, with;
  double closed = 0.0;
  const double seconds = std::max(options.seconds(), 40.0);  // until its buffers are full, and 10 s
  for (int i = 0; i < (options.quick ? 1 : 3); ++i) {
    for (const int stopped : {0, 1}) {
      std::string why_not;
      const auto [frames, stalled] = frames_with(stopped, seconds, why_not);
      if (!why_not.empty()) report.note("a round did not run: " + why_not);
      report.row({std::string(stopped == 0 ? "nobody" : "a stopped page"),
                  static_cast<long long>(i + 1), frames, stalled,
                  fmt::format("{:.1f}", load_average())});
      (stopped == 0 ? without : with).push_back(frames);
      closed += stalled;
    }
  }
  report.bar("frames of the slowest of 16 pages with a stopped one beside them / without",
             median(with) / median(without), kFramesBar, BoundKind::kAtLeast);
  report.bar("stopped pages that were closed", closed, static_cast<double>(with.size()),
             BoundKind::kAtLeast);
}

void section_memory(Report& report, const WebOptions& options) {
  const double seconds = options.quick ? 40.0 : 180.0;
  BenchServer server(kScene);
  BenchGateway gateway(server);
  std::vector<std::pair<double, double>> mb_at_s;
  const double without_mb = gateway.resident_mb();
  double most_mb = 0.0;
  const double start_s = steady_s();
  long long came = 0;
  while (steady_s() - start_s < seconds) {
    // They come, move, and go without a word.
    PageLoad::Shape shape;
    shape.pages = kPages;
    shape.moves = true;
    shape.first_part = 0;
    PageLoad pages(gateway, shape);
    if (!pages.joined()) report.note("pages did not get in: " + pages.why_not());
    came += kPages;
    for (int i = 0; i < 8; ++i) {
      sleep_s(0.5);
      mb_at_s.emplace_back(steady_s() - start_s, gateway.resident_mb());
      most_mb = std::max(most_mb, mb_at_s.back().second);
    }
  }
  const MemorySlope slope = slope_of(mb_at_s, 0.4 * seconds);
  report.table("Memory of the gateway while pages come, move parts and go",
               {"pages in all", "seconds", "first MB", "last MB", "MB an hour", "resolution",
                "load average"});
  report.row({came, slope.seconds, slope.first_mb, slope.last_mb, slope.mb_per_h,
              slope.resolution_mb_per_h, fmt::format("{:.1f}", load_average())});
  report.table("Memory of the gateway (resident)",
               {"pages at a time", "MB before the first", "most MB with them", "load average"});
  report.row(
      {static_cast<long long>(kPages), without_mb, most_mb, fmt::format("{:.1f}", load_average())});
  report.bar("gateway with 16 pages that move parts, most MB resident", most_mb, kMemoryBar_mb,
             BoundKind::kAtMost);
  report.bar("growth of the gateway, MB an hour beyond one page of memory",
             slope.mb_per_h - slope.resolution_mb_per_h, kMemoryBar_mb_per_h, BoundKind::kAtMost);
}

int run(int argc, char** argv) {
  static const std::vector<BenchSection<WebOptions>> sections = {
      {"look", "16 pages that look on, beside nobody", section_look},
      {"move", "16 users at 60 Hz as pages, beside the same as bots", section_move},
      {"stopped", "one page that takes nothing, beside 16 others", section_stopped},
      {"memory", "the gateway's memory while pages come and go", section_memory},
  };
  WebOptions options;
  CLI::App app("Browsers beside a session: server, gateway and bots as programs on loopback");
  add_bench_options(app, options, sections);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run_sections(options, sections);
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
